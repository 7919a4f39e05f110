// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A spring between two nodes a and b, with u the unit vector from a to b and l their distance, as SOFA's springs are:
///
///   f_a = -f_b = t u,   t = stiffness (l - rest_length) + damping u.(v_b - v_a)
///
/// Where a and b coincide it has no direction, and makes no force.
struct Spring {
  int a = 0, b = 0;
  double stiffness = 0;     ///< [N/m]
  double damping = 0;       ///< [N s/m]
  double rest_length = 0;   ///< [m]
  bool only_pulls = false;  ///< no force where it is shorter than at rest
};

/// Springs of one set of nodes, or between two: a is then a node of the first set, b one of the second. x, v, f:
/// num_nodes x 3 [m, m/s, N]; of one set, a field counts for both. Throws InputError for nodes that are not there.
class Springs {
 public:
  Springs() = default;
  Springs(std::vector<Spring> springs, int num_nodes) : Springs(std::move(springs), {num_nodes, num_nodes}) {}
  Springs(std::vector<Spring> springs, std::array<int, 2> num_nodes);

  const std::vector<Spring>& springs() const { return springs_; }
  double energy(const Pair<ConstPoints>& x) const;  ///< [J] without damping

  /// f += their forces. Fixes the positions and velocities to which the stiffness below refers.
  void add_force(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f);

  /// The stiffness of a spring between its two nodes, (stiffness - t / l) u u^T + t / l I: exact for a spring without
  /// damping. That of damping itself, df/dv, and the change of its direction are left out, as SOFA does.
  void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const;

  /// first_nodes: where the nodes of each set begin in A; -1: A has none of them.
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes = {0, 0}) const;

 private:
  std::vector<Spring> springs_;
  std::vector<Mat3> stiffness_;  // [N/m] of each at the latest positions
};

/// f -= stiffness (x - rest) for some nodes: springs of no length that hold them where they were at rest. stiffness
/// [N/m]: one for each of the nodes.
void add_anchor_forces(std::span<const int> nodes, std::span<const double> stiffness, ConstPoints rest, ConstPoints x,
                       Points f);

}  // namespace hexaplast
