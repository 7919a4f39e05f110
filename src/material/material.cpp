// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/material/material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/memory.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/types.hpp"
#include "hexaplast/material/rows.hpp"

namespace hexaplast {

namespace {

[[noreturn]] void refuse(std::string_view name, double value, const std::string& where, const std::string& condition) {
  throw InputError(fmt::format("{} = {}{}: must {}", name, value, where, condition));
}

std::string place_of(std::size_t e, const std::vector<Material>& materials) {
  return materials.size() > 1 ? fmt::format(" of element {}", e) : "";
}

/// Where every element begins beyond its limit, hardening never carries one past it.
void require_fracture_beyond_yield(const std::vector<Material>& materials, Names names) {
  const auto begins_beyond = [](const Material& m) {
    return std::isfinite(m.yield_stress) && m.yield_stress > m.fracture_stress;
  };
  if (materials.empty() || !std::ranges::all_of(materials, begins_beyond)) return;
  const auto min = std::ranges::min_element(materials, {}, &Material::yield_stress);
  refuse(called("fracture_stress", names), min->fracture_stress,
         place_of(static_cast<std::size_t>(min - materials.begin()), materials),
         fmt::format("lie in [{}, inf] Pa, from {} on", min->yield_stress, called("yield_stress", names)));
}

void require_branches(const Settings& settings, Names names) {
  const std::size_t count = settings.relaxation.size();
  if (count == 0) return;
  const std::string name(called("relaxation", names));
  if (count % 2 != 0 || count > 2 * kMaxBranches)
    throw InputError(
        fmt::format("{}: {} numbers, must be pairs of a modulus and a time, at most {}", name, count, kMaxBranches));
  const auto require = [&](std::string_view member, auto value) {
    const Row<Settings>& row = *find_row(settings_rows(), member, Names::kMembers);
    if (row.at.get(settings) != static_cast<double>(value))
      throw InputError(
          fmt::format("{} needs {} = {}", name, row.called(names), row.words[static_cast<std::size_t>(value)]));
  };
  require("law", ElasticLaw::kCorotated);
  require("bending", Bending::kAssumedCorner);
  require("volumetric", Volumetric::kVolumeRatio);
}

/// Of a body that flows with isolated rest shapes.                                                theory.md section 5.9
void require_isolated_flow(const Settings& settings, Names names) {
  const auto refuse_given = [&](std::string_view member, std::string_view has) {
    const Row<Settings>& row = *find_row(settings_rows(), member, Names::kMembers);
    throw InputError(fmt::format("{} = {} of a body that flows needs {} = joined: isolated rest shapes have {}",
                                 row.called(names), row.words[static_cast<std::size_t>(row.at.get(settings))],
                                 called("rest_shape", names), has));
  };
  if (settings.law != ElasticLaw::kCorotated) refuse_given("law", "corotated");
  if (settings.bending == Bending::kVertex || settings.bending == Bending::kCentre)
    refuse_given("bending", "assumedCorner and blended");
  if (settings.rotation_plasticity == RotationPlasticity::kVertex ||
      settings.rotation_plasticity == RotationPlasticity::kCentre)
    refuse_given("rotation_plasticity", "no flow of rotation");
}

/// The rates among the members: their largest products with the time step, which warn only where they have no limit.
template <class Options>
void check_rates(std::span<const Row<Options>> rows, std::span<const Options> all, double dt, Names names,
                 bool have_limits, std::vector<std::string>& warnings) {
  for (const Row<Options>& row : rows) {
    if (std::isinf(row.per_step.max) && std::isinf(row.recommended_per_step)) continue;
    double rate = 0;
    for (const Options& options : all) rate = std::max(rate, row.at.get(options));
    const double product = rate * dt;
    const auto sentence = [&](const std::string& judgement) {
      return fmt::format("{} = {} {} times dt = {} s is {:.6g}: {}", row.called(names), rate, row.unit, dt, product,
                         judgement);
    };
    if (!row.per_step.contains(product)) {
      if (have_limits)
        throw InputError(sentence(
            fmt::format("must be {} {:.6g}", row.per_step.exclusive_max ? "below" : "at most", row.per_step.max)));
      warnings.push_back(sentence("all of the excess flows in each step, at no rate"));
    } else if (product > row.recommended_per_step) {
      warnings.push_back(sentence(fmt::format("results lose accuracy above {}", row.recommended_per_step)));
    }
  }
}

/// Isolated rest shapes let a sample change its volume, which volumetric = sample resists there: where more flows in a
/// step, this can raise the energy.                                                              theory.md section 5.9
void require_flow_that_lowers_energy(const std::vector<Material>& materials, double dt, Names names) {
  for (std::size_t e = 0; e < materials.size(); ++e) {
    const Material& m = materials[e];
    const double product = m.flow_rate * dt, max = 1 - 2 * m.poisson_ratio;
    if (can_stretch(m) && product > max * (1 + 1e-12))  // rounding of decimal numbers
      refuse(called("flow_rate", names), m.flow_rate, place_of(e, materials),
             fmt::format("be at most (1 - 2 {}) / dt = {:.6g} 1/s with {} = isolated and {} = sample",
                         called("poisson_ratio", names), max / dt, called("rest_shape", names),
                         called("volumetric", names)));
  }
}

}  // namespace

Lame lame(double young_modulus, double poisson_ratio) {
  const double E = young_modulus, nu = poisson_ratio;
  return {E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))};
}

void validate(const std::vector<Material>& materials, Names names) {
  for (std::size_t e = 0; e < materials.size(); ++e)
    for (const Row<Material>& row : material_rows())
      if (const double value = row.at.get(materials[e]); !row.admits(value))
        refuse(row.called(names), value, place_of(e, materials), row.condition());
  require_fracture_beyond_yield(materials, names);
}

void validate(const Settings& settings, Names names) {
  for (const Row<Settings>& row : settings_rows())
    for (const double value : row.values(settings))
      if (!row.admits(value)) refuse(row.called(names), value, "", row.condition());
  const auto require = [&](std::string_view member, auto value, std::string_view other_member, auto needed,
                           std::string_view reason = "") {
    const Row<Settings>& row = *find_row(settings_rows(), member, Names::kMembers);
    const Row<Settings>& other = *find_row(settings_rows(), other_member, Names::kMembers);
    if (row.at.get(settings) == static_cast<double>(value) && other.at.get(settings) != static_cast<double>(needed))
      throw InputError(fmt::format("{} = {} needs {} = {}{}", row.called(names),
                                   row.words[static_cast<std::size_t>(value)], other.called(names),
                                   other.words[static_cast<std::size_t>(needed)], reason));
  };
  const auto require_double = [&](std::string_view member, auto value) {
    require(member, value, "precision", Precision::kDouble);
  };
  for (const Bending bending : {Bending::kBlended, Bending::kVertex, Bending::kCentre})
    require_double("bending", bending);
  require_double("volumetric", Volumetric::kSample);
  for (const RotationPlasticity mode : {RotationPlasticity::kVertex, RotationPlasticity::kCentre})
    require_double("rotation_plasticity", mode);
  require_double("averaging", AveragingMethod::kJacobi);
  require_double("implementation", Implementation::kPlain);
  require("yield_stress_measure", YieldStressMeasure::kCauchy, "rest_shape", RestShape::kIsolated);
  require("fracture", Fracture::kFace, "rest_shape", RestShape::kIsolated);
  require("fracture", Fracture::kFace, "implementation", Implementation::kAuto);
  require("fracture", Fracture::kFace, "bending", Bending::kAssumedCorner);
  require("fracture", Fracture::kFace, "volumetric", Volumetric::kVolumeRatio);
  require("fracture", Fracture::kFace, "averaging", AveragingMethod::kGaussNewton);
  require("yield_stress_measure", YieldStressMeasure::kCauchy, "volumetric", Volumetric::kVolumeRatio);
  require_branches(settings, names);
}

void validate(const std::vector<Material>& materials, const Settings& settings, Names names) {
  if (settings.rest_shape == RestShape::kJoined) {
    if (!can_flow(materials, settings)) return;
    if (settings.num_branches() > 0)
      throw InputError(fmt::format("{} of a body that yields needs {} = isolated", called("relaxation", names),
                                   called("rest_shape", names)));
    if (settings.precision == Precision::kMixed)
      throw InputError(fmt::format("{} = joined of a body that flows needs {} = double", called("rest_shape", names),
                                   called("precision", names)));
    return;
  }
  for (std::size_t e = 0; e < materials.size(); ++e)
    if (can_rotate(materials[e], settings))
      refuse(called("rotation_flow_rate", names), materials[e].rotation_flow_rate, place_of(e, materials),
             fmt::format("be 0 with {0} = isolated, where stretch alone keeps a twist; {0} = joined has it",
                         called("rest_shape", names)));
  if (can_flow(materials, settings)) require_isolated_flow(settings, names);
}

bool can_stretch(const Material& material) { return material.flow_rate > 0 && std::isfinite(material.yield_stress); }

bool can_rotate(const Material& material, const Settings& settings) {
  return settings.rotation_plasticity != RotationPlasticity::kNone && material.rotation_flow_rate > 0;
}

bool can_flow(const std::vector<Material>& materials, const Settings& settings) {
  return std::ranges::any_of(
      materials, [&](const Material& material) { return can_stretch(material) || can_rotate(material, settings); });
}

bool is_plain(const std::vector<Material>& materials, const Settings& settings) {
  return settings.implementation == Implementation::kPlain || settings.bending != Bending::kAssumedCorner ||
         settings.volumetric == Volumetric::kSample || settings.averaging == AveragingMethod::kJacobi ||
         settings.rotation_plasticity == RotationPlasticity::kVertex ||
         settings.rotation_plasticity == RotationPlasticity::kCentre ||
         (settings.rest_shape == RestShape::kJoined && can_flow(materials, settings));
}

double bytes_per_hexahedron(const std::vector<Material>& materials, const Settings& settings) {
  const bool flows = can_flow(materials, settings);
  const bool is_isolated = settings.rest_shape == RestShape::kIsolated;
  const bool has_stretches = is_isolated ? flows : std::ranges::any_of(materials, [](const Material& material) {
    return std::isfinite(material.fracture_stretch);
  });
  const bool turns_at_corners = settings.rotation_plasticity == RotationPlasticity::kVertex ||
                                settings.rotation_plasticity == RotationPlasticity::kCentre;
  // what not every history has stands in the trial history of a step once more
  const double tensors = (has_stretches ? kCorners : 0) + (turns_at_corners ? kCorners - 1 : 0);
  const double of_branches = settings.num_branches() > 0 ? 1 + settings.num_branches() : 0;  // of six numbers
  const double bytes_of_branches = 2 * of_branches * kCorners * 6 * sizeof(double);
  if (is_plain(materials, settings))
    return 11000 + bytes_of_branches + (is_isolated && flows ? 2600 : 0) + (flows ? 2 : 1) * tensors * sizeof(Mat3) +
           (flows ? 1000 : 0);
  const double coefficients = 93 + (settings.law != ElasticLaw::kCorotated ? 56 : 0);
  const double of_cycles = 81;
  const double of_latest = 51;  // masses and fixed axes of the latest eigenvalues, positions of the latest energy
  const double of_relaxation = of_branches > 0 && !flows ? 440 + tensors * sizeof(Mat3) : 0;  // the trial of a step
  const double more = (flows ? 2 : 1) * tensors * sizeof(Mat3) + bytes_of_branches + of_relaxation +
                      coefficients * (settings.precision == Precision::kMixed ? 2 : sizeof(double)) + 2 * of_cycles +
                      2 * sizeof(float) + of_latest +
                      (settings.recovery != RecoveryMode::kNone ? 3 * sizeof(double) : 0);
  if (settings.precision == Precision::kMixed) return more + (flows ? 4100 : kMinBytesPerHexahedron);
  return more + (flows ? 5600 : 3400);
}

std::vector<std::string> check_time_step(const std::vector<Material>& materials, const Settings& settings, double dt,
                                         Names names) {
  std::vector<std::string> warnings;
  // without yield a body is at rest in its initial shape for ever: the plastic step does nothing
  if (!can_flow(materials, settings)) return warnings;
  const bool is_joined = settings.rest_shape == RestShape::kJoined;
  check_rates<Material>(material_rows(), materials, dt, names, is_joined, warnings);
  if (is_joined)
    check_rates<Settings>(settings_rows(), std::span(&settings, 1), dt, names, true, warnings);
  else if (settings.volumetric == Volumetric::kSample)
    require_flow_that_lowers_energy(materials, dt, names);
  return warnings;
}

Material filled(Material material, double fraction) {
  material.young_modulus *= fraction;
  material.yield_stress *= fraction;
  material.fracture_stress *= fraction;
  return material;
}

}  // namespace hexaplast
