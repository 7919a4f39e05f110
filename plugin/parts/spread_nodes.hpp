// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/mesh/node_copies.hpp"

namespace hexaplast::parts {

/// The present nodes of a list of initial ones: all copies of each entry, entry by entry.
struct SpreadNodes {
  std::vector<int> nodes = {};
  std::vector<int> entries = {};    ///< of the list, one per present node
  std::vector<double> shares = {};  ///< that each has of its initial node
};

/// copies: null where no node has ever split.
inline SpreadNodes spread(std::span<const int> initial, const NodeCopies* copies) {
  SpreadNodes all;
  for (std::size_t i = 0; i < initial.size(); ++i)
    for (const int node : copies ? copies->of(initial[i]) : initial.subspan(i, 1)) {
      all.nodes.push_back(node);
      all.entries.push_back(static_cast<int>(i));
      all.shares.push_back(copies ? copies->share()[node] : 1);
    }
  return all;
}

}  // namespace hexaplast::parts
