// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "hexaplast/body.hpp"
#include "hexaplast/contact/contact_terms.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// What all contacts of bodies have.
struct ContactOptions {
  std::optional<double> contact_stiffness = std::nullopt;  ///< [Pa/m] otherwise 30 E / edge length of the softer body
  std::optional<double> tangential_stiffness = std::nullopt;  ///< [Pa/m] otherwise contact_stiffness
  double friction = 0;
  double contact_distance = 0;  ///< [m]
  double damping = 0;           ///< [Pa s/m]
  int max_subdivision = 8;      ///< parts of the edge of a face, at most
  bool active = true;           ///< otherwise nothing touches

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(contact_stiffness);
    HEXAPLAST_OPTION(tangential_stiffness);
    HEXAPLAST_OPTION(friction);
    HEXAPLAST_OPTION(contact_distance);
    HEXAPLAST_OPTION(damping);
    HEXAPLAST_OPTION(max_subdivision);
    HEXAPLAST_OPTION(active);
  }

  /// default_stiffness [Pa/m]: of contact, where there is no contact_stiffness.
  ContactSettings settings(double default_stiffness) const {
    const double stiffness = contact_stiffness.value_or(default_stiffness);
    return {.stiffness = stiffness,
            .tangential_stiffness = tangential_stiffness.value_or(stiffness),
            .friction = friction,
            .distance = contact_distance,
            .damping = damping,
            .is_active = active};
  }
};

/// [Pa/m] of contact by default: 30 E / edge length, with the greatest Young's modulus and the mean edge, so that a
/// pressure of .3 E is held at a hundredth of an edge.
inline double default_contact_stiffness(const Body& body) {
  const double edge = std::cbrt(body.initial_volume() / body.mesh().num_elements());
  return 30 * std::ranges::max(body.materials(), {}, &Material::young_modulus).young_modulus / edge;
}

}  // namespace hexaplast::parts
