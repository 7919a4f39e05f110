// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/base/types.hpp"
#include "kinematics/sampling.hpp"
#include "mesh/trilinear.hpp"

namespace hexaplast {

/// det(J) J^-T, defined for singular J too.
Mat3 cofactor(const Mat3& J);

/// d volume(x) / d x_a, exactly; one row per corner [m^2].                                    theory.md eq. E6
ElementPoints volume_gradient(const ElementPoints& x);

/// Gm_a = (1/V) int grad N_a dV, exactly; one row per corner [1/m].                           theory.md eq. 9
ElementPoints mean_gradient(const ElementPoints& x);

/// Deformation gradients at the eight blended samples of one element, as a linear map of its current corner positions.
///
///   F_i  = Jhat_i J_i^-1                              at corner i, Jhat of the current positions     (theory.md eq. 1)
///   F~_i = F_i / 2 + sum_a xh_a (x) h_a               blended and corrected                        (theory.md eq. 7)
///   h_a  = Gm_a - mean_j g_ja / 2
///
/// g_ja is the gradient of shape function a at corner j, Gm_a = (1/V) int grad N_a dV its exact mean. This equals
/// (F_i + F_o)/2 + F_m - mean_j (F_j + F_o)/2: on parallelepipeds the blend of corner and centre, and on every
/// hexahedron with the exact mean, without which the patch test fails.
///
/// The other schemes have the same form: F_i = corner_weight F_i(corner) + sum_a xh_a (x) h_a, with corner_weight = 1
/// and h = 0 at the corners alone, corner_weight = 0 and h = the gradients at the centre there.
struct RestOperator {
  std::array<Mat3, kCorners> inverse_jacobian;  ///< [1/m] J_i^-1
  ElementPoints shared_gradient;                ///< [1/m] h_a
  double corner_weight = 0.5;                   ///< [-] of F_i: Sampling::corner_weight
  double volume = 0;                            ///< [m^3] each sample carries an eighth of it
};

RestOperator rest_operator(const ElementPoints& plastic_rest, const Sampling& sampling = {});

/// g~_ia, one row per corner a: dF~_i = sum_a dxh_a (x) g~_ia.
ElementPoints sample_gradient(const RestOperator& rest, int sample);

}  // namespace hexaplast
