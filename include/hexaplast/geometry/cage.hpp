// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// Axis-aligned box [min, max] [m] cut into cells[0] x cells[1] x cells[2] equal cells: what a cage is cut out of.
struct CageGrid {
  std::array<int, 3> cells{1, 1, 1};
  Vec3 min = Vec3::Zero(), max = Vec3::Ones();
};

/// Fraction of its size by which the box around a surface is widened at either side: no part of the surface then lies
/// in the border of the grid.
inline constexpr double kCageMargin = 0.01;

/// Box around points, widened by kCageMargin of its own size in each direction, as SOFA's sparse grids do.
Eigen::AlignedBox3d box_around(ConstPoints points);

/// A grid of cubes around points (num_points x 3 [m]), with `cells` of them along the longest side of the box around
/// them. Throws InputError when cells < 1, or the points do not extend in any direction.
CageGrid cubes_around(ConstPoints points, int cells);

/// Coarse hexahedra around a surface. They are cells of one grid: neighbours share whole faces.
struct Cage {
  HexMesh mesh;         ///< nodes ascend by x, then y, then z; hexahedra by z, then y, then x within the two kinds
  int num_touched = 0;  ///< of the hexahedra, the first ones: the surface passes through them
  int num_parts = 0;    ///< hexahedra that hang together by faces form one part
  int num_hinges = 0;   ///< nodes at which hexahedra meet that are not joined by faces there: free to fold about them
};

/// The cells of `grid` that a surface touches, and those that it keeps apart from the border of the grid, in the order
/// in which SOFA's SparseGridTopology numbers them. A surface need not be closed, but no cell that it winds around more
/// than half may be reached from outside through one of its holes.
///
/// x: num_nodes x 3 [m], triangles and quads with corners in x; a quad counts as the two triangles on either side of
/// its first diagonal. Throws InputError when there is no face, a corner does not exist, is not finite or lies outside
/// the box, the box is empty, the grid has more than kMaxCageCells cells, or a hole would leave the cage hollow.
Cage cage_around(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads, const CageGrid& grid);

inline constexpr double kMaxCageCells = 134'217'728;  // of the whole grid: a byte each while the cage is made

}  // namespace hexaplast
