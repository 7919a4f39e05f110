// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <Eigen/LU>        // determinant and inverse of 3x3

namespace hexaplast {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// Nodal field: one row (x, y, z) per node, contiguous in memory (the layout of SOFA's Vec3d vectors).
using PointArray = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Views of a nodal field, whose rows follow one another in memory without gaps. Rows with gaps, as those of
/// state.leftCols<3>() have where positions and velocities stand side by side, are no Points (it does not compile), and
/// as ConstPoints they are copied.
using Points = Eigen::Ref<PointArray, 0, Eigen::OuterStride<3>>;             ///< writable
using ConstPoints = Eigen::Ref<const PointArray, 0, Eigen::OuterStride<3>>;  ///< read-only

/// One row (x, y, z) per corner of a hexahedron.
using ElementPoints = Eigen::Matrix<double, 8, 3>;

}  // namespace hexaplast
