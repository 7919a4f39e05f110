// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Cells of a grid and the numbers of their nodes: i + n0 (j + n1 k), cells alike.
struct NodeLattice {
  std::array<int, 3> cells;
  bool is_closed_around = false;  ///< the second direction ends where it began

  /// Throws InputError for a count < least (3 around), or more nodes than an int can count.
  void check(int least = 1) const;

  int num_nodes(int direction) const { return cells[direction] + (is_closed_around && direction == 1 ? 0 : 1); }
  int num_nodes() const { return num_nodes(0) * num_nodes(1) * num_nodes(2); }
  int node(int i, int j, int k) const { return i + num_nodes(0) * (j % num_nodes(1) + num_nodes(1) * k); }
  std::vector<Hexahedron> hexahedra() const;
};

}  // namespace hexaplast
