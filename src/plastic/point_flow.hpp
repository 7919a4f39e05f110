// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"
#include "hexaplast/material/material.hpp"
#include "kinematics/polar.hpp"

namespace hexaplast {

/// Size of a stress [Pa] in the given norm.                                                   theory.md eq. 20
double stress_norm(const Mat3& sigma, YieldNorm norm);

/// The threshold [Pa] after a fraction has flowed: max(0, threshold + hardening fraction value).       theory.md eq. 23
double hardened(double threshold, double hardening, double fraction, double value);

/// What one corner's stretch contributes in one step.
struct StretchFlow {
  Mat3 increment = Mat3::Identity();  ///< S^p = V (D / det(D)^1/3)^gamma V^T, det = 1                      eq. 22
  double fraction = 0;                ///< gamma [-]
  double norm = 0;                    ///< |sigma| [Pa]
  double strain = 0;                  ///< [-] sqrt(2/3) gamma |dev log D|_F
  double dissipated = 0;              ///< [J/m^3] sigma : gamma dev log D
};

/// S: stretch of a sample that is not inverted (det S > 0); sigma [Pa]: its stress. yield_stress is the corner's
/// present threshold [Pa].
StretchFlow stretch_flow(const Mat3& S, const Mat3& sigma, YieldNorm norm, double yield_stress, double rate, double dt,
                         ElasticLaw law = ElasticLaw::kCorotated);

}  // namespace hexaplast
