// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/contact_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hexaplast::parts {
namespace {

constexpr double kMaxStiffness = 1e3;  // of the default: beyond it a body at rest bounces from step to step
constexpr double kMaxDistance = 0.5;   // of contact, in edges

}  // namespace

ContactSettings ContactOptions::settings(double default_stiffness) const {
  const double max = kMaxStiffness * default_stiffness;
  const auto check = [&](std::string_view option, const std::optional<double>& stiffness) {
    if (stiffness && *stiffness > max)
      throw OptionError(option, fmt::format("is {:.6g}, must be at most {:.3g} Pa/m, a thousand times the default of "
                                            "contactStiffness, 30 E / edge length",
                                            *stiffness, max));
  };
  check("contact_stiffness", contact_stiffness);
  check("tangential_stiffness", tangential_stiffness);
  const double stiffness = contact_stiffness.value_or(default_stiffness);
  return {.stiffness = stiffness,
          .tangential_stiffness = tangential_stiffness.value_or(stiffness),
          .friction = friction,
          .distance = contact_distance,
          .damping = damping,
          .is_active = active};
}

void ContactOptions::check_distance(double edge) const {
  if (const double max = kMaxDistance * edge; contact_distance > max)
    throw OptionError("contact_distance",
                      fmt::format("is {:.6g}, must be at most {:.3g} m, half of the mean edge", contact_distance, max));
}

double mean_edge(const Body& body) {
  double volume = 0;
  for (int e = 0; e < body.mesh().num_elements(); ++e) volume += body.initial_volume(e);
  return std::cbrt(volume / body.mesh().num_elements());
}

double default_contact_stiffness(const Body& body, double edge) {
  return 30 * std::ranges::max(body.materials(), {}, &Material::young_modulus).young_modulus / edge;
}

}  // namespace hexaplast::parts
