// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "scene/seen.hpp"

namespace hexaplast::output {

/// An instrument that holds or touches a body, and its force.
struct Instrument {
  int id = 0;                            ///< its number among the instruments of the scene
  Vec3 place;                            ///< [m] of the tool
  std::vector<int> nodes;                ///< on which it acts
  PointArray forces = PointArray(0, 3);  ///< [N] on them, one row each

  PointArray shape_points = PointArray(0, 3);  ///< [m] of its surface; empty: it has no shape
  std::vector<Triangle> shape_triangles = {};  ///< of these points, counter-clockwise seen from outside

  /// [m] Where its force acts: the mean of its nodes, by their forces. A shape's own origin may lie far from where it
  /// touches. Without a shape, or without a force: place. positions: of the body's nodes [m].
  Vec3 acts_at(ConstPoints positions) const;

  /// [N] on the body.
  Vec3 force() const { return forces.rows() == 0 ? Vec3::Zero() : Vec3(forces.colwise().sum()); }
};

using scene::SpringLine;

/// What holds and loads a body at a moment, but for its weight.
struct BoundaryConditions {
  std::vector<unsigned char> fixed;  ///< per node: 1 where all directions are fixed or prescribed; empty: none
  PointArray loads =
      PointArray(0, 3);  ///< [N] external forces, those of instruments included: num_nodes x 3; empty: none
  std::vector<Instrument> instruments;
  std::vector<SpringLine> springs = {};
};

/// A force on a node that no instrument makes.
struct NodalLoad {
  int node;
  Vec3 force;  ///< [N]
};

/// Those that are worth showing: where they lie close together, the strongest stands for its neighbourhood in the
/// initial shape. alive: per hexahedron; nodes that hold nothing together are left out.
std::vector<NodalLoad> shown_loads(const HexMesh& mesh, std::span<const unsigned char> alive,
                                   const BoundaryConditions& conditions);

}  // namespace hexaplast::output
