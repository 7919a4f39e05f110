// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <Eigen/LU>        // determinant and inverse of 3x3
#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>

#include "hexaplast/base/corners.hpp"

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

/// Nodal fields of two bodies, or of one body twice.
template <class Field>
struct Pair {
  template <class Same>
  requires std::convertible_to<Same&&, Field> Pair(Same&& both) : first(both), second(both) {}
  template <class First, class Second>
  Pair(First&& of_first, Second&& of_second) : first(of_first), second(of_second) {}

  Field first, second;
};

/// One row (x, y, z), one number and one tensor per corner.
using ElementPoints = Eigen::Matrix<double, kCorners, 3>;
using CornerValues = std::array<double, kCorners>;
using CornerTensors = std::array<Mat3, kCorners>;

/// The same for all cells of the same nodes, whatever their order.
template <std::size_t N>
std::array<int, N> sorted(std::array<int, N> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace hexaplast
