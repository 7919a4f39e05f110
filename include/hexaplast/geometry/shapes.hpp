// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/mesh/hex_mesh.hpp"

/// Bodies that are grids bent into shape: cells[0] x cells[1] x cells[2] hexahedra along three directions that each
/// body names. Nodes lie on the exact surfaces; node (i, j, k) has the index i + n0 (j + n1 k), n0 and n1 being the
/// numbers of nodes along the first two directions, and hexahedra are numbered alike (the first direction fastest).
///
/// All throw InputError for a cell count < 1, more nodes than an int can count, a size [m] that is not a finite number
/// > 0, and shapes that fold or run into themselves.
namespace hexaplast {

/// A sheet of size[0] x size[1] x thickness [m], centred at the origin, its middle surface in the plane z = 0. With a
/// curvature of 1/R [1/m] it is bent about an axis along y that lies R below (above, where it is negative); the middle
/// surface keeps its lengths. cells: along x, along y, across the thickness.
HexMesh sheet(std::array<int, 3> cells, std::array<double, 2> size, double thickness, double curvature = 0);

/// A patch of a spherical shell between two radii [m] about the origin: what is seen from there, along z, through a
/// square window of `angle` [rad, below pi] from side to side. The grid lines are great circles at equal angles.
/// cells: along x, along y, outward.
HexMesh sphere_patch(std::array<int, 3> cells, double inner, double outer, double angle);

/// A curve for a tube to follow: points [m] and unit tangents, in order.
struct Centreline {
  PointArray points;    ///< num_points x 3
  PointArray tangents;  ///< num_points x 3
};

/// From the origin along z, bent towards x by `angle` [rad, between -2 pi and 2 pi] in all, over `length` [m];
/// num_points >= 2.
Centreline arc(double length, double angle, int num_points);

/// The smooth curve through given points [m] (at least two, no two consecutive ones at the same place), at num_points
/// >= 2 points of equal distances along it: cubic between the given points, with the tangents of the parabola through
/// each three of them.
Centreline curve_through(ConstPoints points, int num_points);

/// A tube between two radii [m] around a curve of cells[2] + 1 points. Its sections stand normal to the curve, in
/// frames of least rotation, so that the hexahedra are not twisted about it; the first node of the first section lies
/// on the side of x, or of y where the curve begins along x. cells: outward, around (at least 3), along.
HexMesh tube(std::array<int, 3> cells, double inner, double outer, const Centreline& along);

}  // namespace hexaplast
