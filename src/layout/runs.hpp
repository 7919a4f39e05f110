// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Four hexahedra in a row, each sharing with the next the face that both have across the same local axis, are a run.
/// Where its nodes lie side by side in memory as well, one wide load takes what four narrow ones would.
inline constexpr int kRun = 4;

/// The order in which the kernels take elements, and in which they want the nodes.
struct RunOrder {
  /// Element at each place of each block, or -1 in the last one: [block][element of the block]. A block of runs has the
  /// first elements of its four runs at places 0 to 3, the second ones at 4 to 7, and so on. The order follows that of
  /// the mesh as far as the runs allow.
  std::vector<int> element_of_place;

  int axis = 0;                ///< local axis of the runs
  std::vector<int> next_node;  ///< per node: the next one along the runs, or -1
};

/// Runs along one local axis: of those that give nearly the most, the one that the mesh is numbered along. Elements
/// without are put together in blocks of their own.
RunOrder order_by_runs(int num_nodes, const std::vector<Hexahedron>& hexahedra);

}  // namespace hexaplast
