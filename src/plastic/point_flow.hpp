// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"
#include "hexaplast/material/material.hpp"
#include "kinematics/polar.hpp"

namespace hexaplast {

/// Size of a stress [Pa] in the given norm.                                                   theory.md eq. 20
double stress_norm(const Mat3& sigma, YieldNorm norm);

/// Fraction of the excess that flows in dt: clamp(rate dt (value - threshold) / (value + offset), 0, 1); 0 for
/// value <= threshold. Used for stretch (value |sigma| [Pa]) and for rotation (value phi [rad]); the offset is that of
/// the paper's rotation modes.                                                               theory.md eq. 21, 25
double flow_fraction(double value, double threshold, double rate, double dt, double offset = 0);

/// The threshold [Pa or rad] after that: max(0, threshold + hardening fraction value).           theory.md eq. 23, 25
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

/// What one corner's rotation contributes in one step.
struct RotationFlow {
  Mat3 increment = Mat3::Identity();  ///< R^p = rotation^eta                                               eq. 26
  double fraction = 0;                ///< eta [-]
  double angle = 0;                   ///< phi [rad], rotation angle of R_o^T R_i, in [0, pi]                eq. 24
};

/// rotation: what flows, R_o^T R_i in the objective mode. angle: phi [rad]. pose_angle: Phi(I, R_o) [rad] in the
/// paper's modes, 0 in the objective one.
RotationFlow rotation_flow(const Mat3& rotation, double angle, double pose_angle, double rotation_yield, double rate,
                           double dt);

}  // namespace hexaplast
