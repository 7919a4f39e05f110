// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/material/material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/hexahedron.hpp"
#include "hexaplast/base/memory.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

namespace {

void require(bool accepted, const char* name, double value, const std::string& where, const char* allowed) {
  if (!accepted) throw InputError(fmt::format("{} = {}{}: must lie in {}", name, value, where, allowed));
}

std::string place_of(std::size_t e, const std::vector<Material>& materials) {
  return materials.size() > 1 ? fmt::format(" of element {}", e) : "";
}

/// Where every element begins beyond its limit, hardening never carries one past it.
void require_fracture_beyond_yield(const std::vector<Material>& materials) {
  const auto begins_beyond = [](const Material& m) {
    return std::isfinite(m.yield_stress) && m.yield_stress > m.fracture_stress;
  };
  if (materials.empty() || !std::ranges::all_of(materials, begins_beyond)) return;
  const auto least = std::ranges::min_element(materials, {}, &Material::yield_stress);
  require(false, "fractureStress", least->fracture_stress,
          place_of(static_cast<std::size_t>(least - materials.begin()), materials),
          fmt::format("[{}, inf] Pa, from yieldStress on", least->yield_stress).c_str());
}

double largest(const std::vector<Material>& materials, double Material::*rate) {
  double most = 0;
  for (const Material& material : materials) most = std::max(most, material.*rate);
  return most;
}

}  // namespace

Lame lame(double young_modulus, double poisson_ratio) {
  const double E = young_modulus, nu = poisson_ratio;
  return {E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))};
}

void validate(const std::vector<Material>& materials) {
  for (std::size_t e = 0; e < materials.size(); ++e) {
    const Material& m = materials[e];
    const std::string where = place_of(e, materials);
    // a comparison with NaN is false, so every test is written to accept, never to refuse
    require(m.young_modulus > 0 && std::isfinite(m.young_modulus), "youngModulus", m.young_modulus, where,
            "(0, inf) Pa");
    require(m.poisson_ratio >= 0 && m.poisson_ratio < 0.5, "poissonRatio", m.poisson_ratio, where, "[0, 0.5)");
    require(m.yield_stress >= 0, "yieldStress", m.yield_stress, where, "[0, inf] Pa");
    require(m.flow_rate >= 0 && std::isfinite(m.flow_rate), "plasticFlowRate", m.flow_rate, where, "[0, inf) 1/s");
    require(m.rotation_yield >= 0 && m.rotation_yield <= std::numbers::pi, "rotationYield", m.rotation_yield, where,
            "[0, pi] rad");
    require(m.rotation_flow_rate >= 0 && std::isfinite(m.rotation_flow_rate), "rotationFlowRate", m.rotation_flow_rate,
            where, "[0, inf) 1/s");
    require(std::isfinite(m.hardening), "hardening", m.hardening, where, "(-inf, inf)");
    require(m.fracture_stress >= 0, "fractureStress", m.fracture_stress, where, "[0, inf] Pa");
    require(m.fracture_stretch > 1, "fractureStretch", m.fracture_stretch, where, "(1, inf]");
  }
  require_fracture_beyond_yield(materials);
}

bool can_stretch(const Material& material) { return material.flow_rate > 0 && std::isfinite(material.yield_stress); }

bool can_rotate(const Material& material, const Settings& settings) {
  return settings.rotation != RotationPlasticity::kNone && material.rotation_flow_rate > 0;
}

double bytes_per_hexahedron(const std::vector<Material>& materials, const Settings& settings) {
  const bool flows = std::ranges::any_of(
      materials, [&](const Material& material) { return can_stretch(material) || can_rotate(material, settings); });
  const bool tracks_stretch =
      std::ranges::any_of(materials, [](const Material& material) { return std::isfinite(material.fracture_stretch); });
  const bool turns_at_corners =
      settings.rotation == RotationPlasticity::kVertex || settings.rotation == RotationPlasticity::kCentre;
  // what not every history has stands in the trial history of a step once more
  const double tensors = (tracks_stretch ? kCorners : 0) + (turns_at_corners ? kCorners - 1 : 0);
  const double more = (flows ? 2 : 1) * tensors * sizeof(Mat3);
  if (settings.precision == Precision::kMixed) return more + (flows ? 4700 : kLeastBytesPerHexahedron);
  return more + (flows ? 6200 : 3700);
}

void validate(const Settings& settings) {
  require(settings.volume_restitution >= 0 && std::isfinite(settings.volume_restitution), "volumeRestitution",
          settings.volume_restitution, "", "[0, inf) 1/s");
  require(settings.inversion_threshold >= 0 && settings.inversion_threshold < 1, "inversionThreshold",
          settings.inversion_threshold, "", "[0, 1)");
  require(settings.averaging_steps >= 1, "averagingSteps", settings.averaging_steps, "", "[1, inf)");
  require(settings.averaging_tolerance >= 0 && settings.averaging_tolerance <= 0.1, "averagingTolerance",
          settings.averaging_tolerance, "", "[0, 0.1]");
}

std::vector<std::string> check_time_step(const std::vector<Material>& materials, const Settings& settings, double dt) {
  std::vector<std::string> advice;
  const auto check = [&](const char* name, double rate, double limit, bool limit_allowed, double advised) {
    const double product = rate * dt;
    if (product > limit || (product == limit && !limit_allowed))
      throw InputError(fmt::format("{} = {} 1/s times dt = {} s is {:.6g}: must be {} {:.6g}", name, rate, dt, product,
                                   limit_allowed ? "at most" : "below", limit));
    if (product > advised)
      advice.push_back(fmt::format("{} = {} 1/s times dt = {} s is {:.6g}: results lose accuracy above {}", name, rate,
                                   dt, product, advised));
  };
  check("plasticFlowRate", largest(materials, &Material::flow_rate), kLargestFlowPerStep, true, kAdvisedFlowPerStep);
  check("rotationFlowRate", largest(materials, &Material::rotation_flow_rate), kLargestFlowPerStep, true,
        kAdvisedFlowPerStep);
  check("volumeRestitution", settings.volume_restitution, kLargestRestitutionPerStep, false,
        kAdvisedRestitutionPerStep);
  return advice;
}

}  // namespace hexaplast
