// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "hexaplast/body.hpp"

namespace hexaplast::parts {

/// [Pa/m] of contact by default: 30 E / edge length, with the greatest Young's modulus and the mean edge, so that a
/// pressure of .3 E is held at a hundredth of an edge.
inline double default_contact_stiffness(const Body& body) {
  const double edge = std::cbrt(body.initial_volume() / body.mesh().num_elements());
  return 30 * std::ranges::max(body.materials(), {}, &Material::young_modulus).young_modulus / edge;
}

}  // namespace hexaplast::parts
