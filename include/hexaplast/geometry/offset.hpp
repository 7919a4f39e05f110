// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <vector>

#include "hexaplast/geometry/quad_surface.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "hexaplast/mesh/quality.hpp"

namespace hexaplast {

/// Between which surfaces a shell lies, measured normal to the quads from the given one: positive numbers lie on the
/// side that the name says. Their sum, the thickness, may be negative: it is the distance of the two that counts.
struct ShellThickness {
  double inward = 0;   ///< [m] opposite to the normals
  double outward = 0;  ///< [m] along the normals
  int layers = 1;      ///< hexahedra across the thickness
};

/// How far a surface can be moved along its normals before a quad folds: where the distance reaches the radius of
/// curvature on the inner side of a bend. Only neighbours are looked at, not distant parts that run into each other.
struct OffsetLimits {
  double inward = std::numeric_limits<double>::infinity();   ///< [m]
  double outward = std::numeric_limits<double>::infinity();  ///< [m]
};

/// Displacement of every vertex that moves the surface by one unit of length, measured normal to its quads
/// (num_vertices x 3, no unit).
///
/// For quads with normals n_q, angles a_q and edges e_q, g_q at the vertex, the direction is the mean normal m with the
/// weights sin a_q / |e_q| |g_q|: that of a sphere or circle for vertices on one, however it is cut into quads (N. Max,
/// Weights for computing vertex normals from facet normals, 1999). Its length is such that the quads move by one on the
/// mean, sum a_q (n_q . u - 1) = 0: a vertex on an edge or corner moves further than one (it is mitred), and planes,
/// prisms and boxes keep their thickness exactly. Where the surface has an edge or a corner, u also gets the components
/// across m that bring every n_q . u as near to one as possible (least squares with the weights a_q), so that corners
/// without symmetry keep theirs too, however the faces beside them are cut. On smooth surfaces, where those components
/// would only amplify noise, u stays along m.
/// At the boundary of an open surface the quads inside decide alone: the rim stands normal to them.
///
/// Throws InputError, naming the vertices, where no direction leads away from all quads of a vertex: at needles, knife
/// edges and folds.
PointArray offset_directions(const QuadSurface& surface);

/// directions: those of offset_directions.
OffsetLimits offset_limits(const QuadSurface& surface, const PointArray& directions);

/// A shell and what is worth knowing of it.
struct Shell {
  HexMesh mesh;         ///< node: vertex * (layers + 1) + layer, layers counted outward from the inner surface;
                        ///< hexahedron: quad * layers + layer, its corner 0 at the inner surface, below corner 4
  MeshQuality quality;  ///< of `mesh`
  std::vector<int> worst_quads;  ///< up to five, those over which the scaled Jacobian is smallest first
};

/// The shell of hexahedra between the offset surfaces. Where the thickness is negative, "inner" and "outer" above
/// change places, and the hexahedra are right side out all the same. Throws InputError where a thickness is not finite
/// or zero, layers < 1, there are more nodes than an int can count, or a quad folds or makes a hexahedron with a corner
/// inside out: with the quads, the limits and the smallest scaled Jacobian.
Shell offset(const QuadSurface& surface, const ShellThickness& thickness);

}  // namespace hexaplast
