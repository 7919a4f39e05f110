// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"
#include "hexaplast/material/material.hpp"

namespace hexaplast::support {

inline constexpr double kEdge = 0.1;   ///< [m] of the cubes that most tests are made of
inline constexpr double kStep = 0.01;  ///< [s] of their time steps

/// Stretch and rotation flow, and harden. At E = 5000 Pa a strain of a few percent reaches `yield_stress` [Pa].
inline Material yielding(double yield_stress, double rotation_yield) {
  Material m;
  m.yield_stress = yield_stress;
  m.flow_rate = 3;
  m.rotation_yield = rotation_yield;
  m.rotation_flow_rate = 2;
  m.hardening = 0.2;
  return m;
}

inline const Material kSoft = yielding(300, 0.02);

/// The same without a flow of rotation, which isolated rest shapes do not have.
inline Material stretching(double yield_stress) {
  Material m = yielding(yield_stress, 0);
  m.rotation_flow_rate = 0;
  return m;
}

/// Rest shapes as the paper has them, where rotation flows.
inline const Settings kJoined{.rest_shape = RestShape::kJoined};

/// Of the corotated law at a stretch [Pa].                                                            theory.md eq. 12
inline Mat3 corotated_stress(const Mat3& S, const Lame& k) {
  const Mat3 strain = S - Mat3::Identity();
  return 2 * k.mu * strain + k.lambda * strain.trace() * Mat3::Identity();
}

}  // namespace hexaplast::support
