// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Loads that act where something touches the body. x, v, f: num_nodes x 3 [m, m/s, N]. Each of them throws InputError
/// for fields of different sizes and for nodes that they have not.

/// f += pressure [Pa] on a face at its present shape, along the normal that its order of nodes gives: a third of
/// pressure x area on each corner of a triangle; a quad counts as the two triangles on either side of its first
/// diagonal.
void add_pressure(const Triangle& face, double pressure, ConstPoints x, Points f);
void add_pressure(const Quad& face, double pressure, ConstPoints x, Points f);

/// An elastic obstacle that fills the half space n.x < distance, as SOFA's PlaneForceField defines it:
///
///   d = n.x - distance  < 0:   f = -stiffness d n + damping d v,    K = -stiffness n n^T
///
/// The damping is thus stronger the deeper a node is, acts in all directions, and has no part in K. n is taken as it
/// is: not a unit vector, it scales d and f. Where |f| is limited, K = 0; SOFA keeps the K above.
struct Obstacle {
  Vec3 normal = Vec3::UnitY();
  double distance = 0;             ///< [m]
  double stiffness = 500;          ///< [N/m]
  double damping = 5;              ///< [N s/m^2]
  double max_force = 0;            ///< [N] on a node; 0: no limit
  std::vector<double> share = {};  ///< per node (NodeCopies::share), of what it feels; empty: all are whole

  /// The nodes that touch it with a force below the limit, ascending, to which the stiffness below refers.
  void stiff_at(ConstPoints x, ConstPoints v, std::vector<int>& stiff) const;

  /// f += its forces.
  void add_force(ConstPoints x, ConstPoints v, Points f) const;

  void add_stiffness_product(std::span<const int> stiff, double factor, ConstPoints dx, Points df) const;
  void add_stiffness_blocks(std::span<const int> stiff, double factor, BlockMatrix& A) const;

 private:
  double gap(ConstPoints x, int node) const { return x.row(node).dot(normal) - distance; }
  Eigen::RowVector3d unlimited_force(double d, ConstPoints v, int node) const;
  bool is_limited(double size) const { return max_force > 0 && size > max_force; }
  double share_of(int node) const { return share.empty() ? 1 : share[node]; }
};

}  // namespace hexaplast
