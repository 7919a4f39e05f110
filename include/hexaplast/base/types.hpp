// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <Eigen/LU>        // determinant and inverse of 3x3
#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>

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
struct OfTwo {
  template <class Same>
  requires std::convertible_to<Same&&, Field> OfTwo(Same&& both) : first(both), second(both) {}
  template <class First, class Second>
  OfTwo(First&& of_first, Second&& of_second) : first(of_first), second(of_second) {}

  Field first, second;
};

/// The trilinear hexahedron: corner order of SOFA, VTK (cell 12) and Gmsh (type 5), and what follows from it.
///
///        7--------6
///       /|       /|        corner a lies at s = kCornerSign[a] in the reference cube [-1, 1]^3
///      4--------5 |
///      | 3------|-2        z  y
///      |/       |/         | /
///      0--------1          o-- x
inline constexpr int kCorners = 8;

inline constexpr std::array<std::array<int, 3>, kCorners> kCornerSign{
    {{-1, -1, -1}, {+1, -1, -1}, {+1, +1, -1}, {-1, +1, -1}, {-1, -1, +1}, {+1, -1, +1}, {+1, +1, +1}, {-1, +1, +1}}};

/// kEdgeNeighbour[a][d]: the corner that differs from corner a in direction d only.
inline constexpr std::array<std::array<int, 3>, kCorners> kEdgeNeighbour{
    {{1, 3, 4}, {0, 2, 5}, {3, 1, 6}, {2, 0, 7}, {5, 7, 0}, {4, 6, 1}, {7, 5, 2}, {6, 4, 3}}};

/// The six faces, corners counter-clockwise seen from outside.
inline constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

/// The twelve edges.
inline constexpr std::array<std::array<int, 2>, 12> kEdges{
    {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3}, {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}}};

/// Corner indices of one hexahedron, and of cells of lower dimension.
using Hexahedron = std::array<int, kCorners>;
using Quad = std::array<int, 4>;
using Triangle = std::array<int, 3>;
using Edge = std::array<int, 2>;

/// Nodes of a face of a hexahedron; face: one of kFaces.
inline Quad face_of(const Hexahedron& nodes, const Quad& face) {
  return {nodes[face[0]], nodes[face[1]], nodes[face[2]], nodes[face[3]]};
}

/// One row (x, y, z) per corner, and one number per corner.
using ElementPoints = Eigen::Matrix<double, kCorners, 3>;
using CornerValues = std::array<double, kCorners>;

/// The same for all cells of the same nodes, whatever their order.
template <std::size_t N>
std::array<int, N> sorted(std::array<int, N> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

}  // namespace hexaplast
