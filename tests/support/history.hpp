// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "body_state.hpp"
#include "support/compare.hpp"

namespace hexaplast::support {

/// Tells a body whose G have been set that all of its hexahedra have flowed.
inline void take_flowed(Body& body) {
  std::ranges::fill(body.state().history.has_flowed, 1);
  ++body.state().history.version;
}

/// Whether what an element has been through is the same but for `rounding`: of lengths over `edge` [m], of angles,
/// strains and stretches, and of stresses over a modulus.
inline void expect_same_history(const ElementHistory& found, const ElementHistory& expected, const Lame& lame,
                                double edge, double rounding) {
  EXPECT_LE(max_abs(found.rest_shape - expected.rest_shape), rounding * edge);
  for (int i = 0; i < kCorners; ++i) {
    EXPECT_LE(max_abs(found.rotation_map[i] - expected.rotation_map[i]), rounding);
    EXPECT_LE(max_abs(found.plastic_stretch[i] - expected.plastic_stretch[i]), rounding);
    EXPECT_LE(max_abs(found.plastic_inverse[i] - expected.plastic_inverse[i]), rounding);
    EXPECT_NEAR(found.plastic_strain[i], expected.plastic_strain[i], rounding);
    EXPECT_NEAR(found.rotation_yield[i], expected.rotation_yield[i], rounding);
    EXPECT_TRUE(found.yield_stress[i] == expected.yield_stress[i] ||  // infinite
                std::abs(found.yield_stress[i] - expected.yield_stress[i]) <=
                    0.1 * rounding * (3 * lame.lambda + 2 * lame.mu));
  }
}

}  // namespace hexaplast::support
