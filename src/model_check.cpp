// SPDX-License-Identifier: LGPL-2.1-or-later
#include "model_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "body_state.hpp"
#include "hexaplast/material/rows.hpp"
#include "kinematics/sampling.hpp"

namespace hexaplast {
namespace {

constexpr double kNearlyIncompressible = 0.49;  // above, trilinear hexahedra lock in bending
constexpr double kLargeYieldStrain = 0.5;
constexpr double kLargestExtent = 2;  // [m]
constexpr double kLargestMass = 500;  // [kg]

}  // namespace

ModelCheck check_model(const Body& body, double mass, double dt) {
  const Model& model = body.state().model;
  const HexMesh& mesh = body.mesh();
  ModelCheck found;
  found.is_plain = model.is_plain;
  found.num_parts = connected_parts(mesh, body.alive()).count;
  if (mesh.num_nodes() > 0)
    found.extent = (mesh.positions().colwise().maxCoeff() - mesh.positions().colwise().minCoeff()).transpose();
  found.volume = body.initial_volume();
  found.quality = quality(mesh);
  found.mass = mass;
  if (mesh.num_elements() == 0) return found;
  found.density = mass / found.volume;

  const auto min_and_max = [&](double Material::*property) {
    const auto [min, greatest] = std::ranges::minmax(model.materials, {}, property);
    return std::pair(min.*property, greatest.*property);
  };
  std::tie(found.min_young_modulus, found.max_young_modulus) = min_and_max(&Material::young_modulus);
  found.locks = body.settings().volumetric == Volumetric::kSample;
  std::tie(found.min_poisson_ratio, found.max_poisson_ratio) = min_and_max(&Material::poisson_ratio);
  found.flow_per_step = min_and_max(&Material::flow_rate).second * dt;
  found.rotation_flow_per_step = min_and_max(&Material::rotation_flow_rate).second * dt;
  if (model.settings.rest_shape == RestShape::kJoined)
    found.restitution_per_step = model.settings.volume_restitution * dt;
  found.yield_stress = min_and_max(&Material::yield_stress).first;
  found.yield_strain = std::numeric_limits<double>::infinity();
  found.rotation_yield = std::numeric_limits<double>::infinity();
  for (const Material& material : model.materials) {
    found.yield_strain = std::min(found.yield_strain, material.yield_stress / material.young_modulus);
    if (model.can_rotate && material.rotation_flow_rate > 0)
      found.rotation_yield = std::min(found.rotation_yield, material.rotation_yield);
  }

  if (mass > 0) {
    double stiffest = 0, stiffest_lumped = 0;  // [Pa] largest of the elements
    const double corner_weight = sampling_of(model.settings).corner_weight;
    for (const Lame& k : model.lame) {
      stiffest = std::max(stiffest, k.lambda + 2 * k.mu);
      // of a cube on its own, which swells or warps; neighbours slow it down
      const double swelling = 3 * k.lambda + 2 * k.mu, warping = corner_weight * corner_weight * (k.lambda + 4 * k.mu);
      stiffest_lumped = std::max({stiffest_lumped, swelling, warping});
    }
    found.wave_speed = std::sqrt(stiffest / found.density);
    found.highest_frequency = 2 * std::sqrt(stiffest_lumped / found.density) / found.quality.shortest_edge;
    found.cfl_number = found.wave_speed * dt / found.quality.shortest_edge;
    found.steps_across = found.extent.maxCoeff() / (found.wave_speed * dt);
  }
  return found;
}

std::vector<std::string> model_warnings(const ModelCheck& check, Names names) {
  std::vector<std::string> sentences;
  const auto say = [&](bool is_unwise, const std::string& sentence) {
    if (is_unwise) sentences.push_back(sentence);
  };
  say(check.quality.num_unused_nodes > 0,
      fmt::format("{} nodes belong to no hexahedron", check.quality.num_unused_nodes));
  say(check.num_parts > 1, fmt::format("the body has {} unconnected parts", check.num_parts));
  say(check.locks && check.max_poisson_ratio > kNearlyIncompressible,
      fmt::format("{} = {}: above {} hexahedra lock in bending unless volumetric is volumeRatio",
                  called("poisson_ratio", names), check.max_poisson_ratio, kNearlyIncompressible));
  say(std::isfinite(check.yield_strain) && check.yield_strain > kLargeYieldStrain,
      fmt::format("{} is reached only at a strain of {:.3g}", called("yield_stress", names), check.yield_strain));
  say(check.wave_speed > 0 && check.steps_across < 1,
      fmt::format(
          "pressure waves cross the body in {:.3g} time steps: vibrations are damped, only slow loads are resolved",
          check.steps_across));
  return sentences;
}

std::vector<std::string> size_warnings(const ModelCheck& check, const Vec3& gravity) {
  std::vector<std::string> sentences;
  constexpr std::string_view kUnit = "are its coordinates in millimetres? They are read as metres";
  if (check.extent.maxCoeff() > kLargestExtent)
    sentences.push_back(fmt::format("the body is {:.3g} m long: {}", check.extent.maxCoeff(), kUnit));
  else if (check.mass > kLargestMass)
    sentences.push_back(fmt::format("the body weighs {:.3g} kg: {}", check.mass, kUnit));
  // a column of height L that stands on the ground is shortened by rho g L^2 / 2 E
  const double shortened = check.density * gravity.cwiseAbs().dot(check.extent) / (2 * check.max_young_modulus);
  if (shortened > 1)
    sentences.push_back(
        fmt::format("its own weight would shorten the body by {:.3g} times its height, as it is {:.3g} "
                    "kg/m^3 at {:.3g} Pa: are density and Young's modulus in SI units?",
                    shortened, check.density, check.max_young_modulus));
  return sentences;
}

std::vector<std::string> fracture_warnings(const std::vector<Material>& materials, const Settings& settings,
                                           Names names) {
  const auto count = [&](auto condition) { return std::ranges::count_if(materials, condition); };
  const auto yields = [](const Material& m) { return std::isfinite(m.yield_stress); };
  const auto flows = [](const Material& m) { return m.flow_rate > 0; };
  const auto hardens = [](const Material& m) { return m.hardening > 0; };
  const auto breaks_by_stress = [](const Material& m) { return std::isfinite(m.fracture_stress); };
  const auto breaks_by_stretch = [](const Material& m) { return std::isfinite(m.fracture_stretch); };
  const auto begins_beyond = [&](const Material& m) {
    return yields(m) && flows(m) && hardens(m) && m.yield_stress > m.fracture_stress;
  };

  const auto name = [&](const char* member) { return std::string(called(member, names)); };
  std::string missing = count(yields) == 0 ? name("yield_stress") : count(flows) == 0 ? name("flow_rate") : "";
  std::vector<std::string> sentences;
  if (!missing.empty() && count(breaks_by_stretch) > 0)
    sentences.push_back(
        fmt::format("{} has no effect: without {} no stretch flows", name("fracture_stretch"), missing));
  if (missing.empty() && count(hardens) == 0) missing = "a " + name("hardening") + " above 0";
  if (!missing.empty() && count(breaks_by_stress) > 0)
    sentences.push_back(
        fmt::format("{} has no effect: without {} the yield stress does not grow", name("fracture_stress"), missing));
  if (missing.empty() && count(begins_beyond) > 0)
    sentences.push_back(fmt::format("{} exceeds {} in {} of {} hexahedra: they tear as soon as they flow",
                                    name("yield_stress"), name("fracture_stress"), count(begins_beyond),
                                    materials.size()));
  if (settings.fracture == Fracture::kCell && count([](const Material& m) { return m.fracture_energy > 0; }) > 0)
    sentences.push_back(fmt::format("{} has no effect: without {} = face no crack grows", name("fracture_energy"),
                                    called("fracture", names)));
  return sentences;
}

std::vector<std::string> idle_option_warnings(const Settings& settings, Names names) {
  std::vector<std::string> sentences;
  if (settings.rest_shape != RestShape::kIsolated) return sentences;
  for (const auto& [member, reason] : {std::pair("rotation_frame", "rotation does not flow"),
                                       {"averaging", "nothing is averaged"},
                                       {"averaging_steps", "nothing is averaged"},
                                       {"averaging_tolerance", "nothing is averaged"},
                                       {"volume_restitution", "flow keeps the volume of a hexahedron"}}) {
    const Row<Settings>& row = *find_row(settings_rows(), member, Names::kMembers);
    if (row.at.get(settings) != row.at.get(Settings()))
      sentences.push_back(fmt::format("{} has no effect with {} = isolated: {}", row.called(names),
                                      called("rest_shape", names), reason));
  }
  return sentences;
}

}  // namespace hexaplast
