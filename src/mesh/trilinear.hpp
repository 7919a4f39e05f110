// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Geometry of one trilinear hexahedron, corners x [m] as rows.

/// dN_a/ds at s, one row per corner.
ElementPoints shape_derivatives(const Vec3& s);

/// Corner i: the columns of J_i = dx/ds are the three half edges that meet there.            theory.md eq. 2
Mat3 corner_jacobian(const ElementPoints& x, int corner);

/// Centre: J_o = dx/ds at s = 0.                                                              theory.md eq. 3
Mat3 centre_jacobian(const ElementPoints& x);

/// The rows about their own mean.
inline ElementPoints about_mean(const ElementPoints& x) { return x.rowwise() - x.colwise().mean(); }

/// det(J) J^-T, defined for singular J too.
Mat3 cofactor(const Mat3& J);

/// Exact volume [m^3] (2x2x2 Gauss points of det J).                                          theory.md eq. 4
double volume(const ElementPoints& x);

/// Calls visit(dN, J) at the 2x2x2 Gauss points (all of weight 1): exact for det J and for cof(J) dN/ds.
template <class Visit>
void for_each_gauss_point(const ElementPoints& x, const Visit& visit) {
  const double at = 1 / std::sqrt(3.0);
  for (const auto& sign : kCornerSign) {
    const ElementPoints dN = shape_derivatives(at * Vec3(sign[0], sign[1], sign[2]));
    visit(dN, Mat3(x.transpose() * dN));
  }
}

}  // namespace hexaplast
