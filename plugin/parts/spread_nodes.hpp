// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "hexaplast/base/types.hpp"
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

/// What initial nodes have, masses for example, divided among their copies by share, and summed again.
inline std::vector<double> shared_out(std::span<const double> of_initial, const NodeCopies& copies) {
  std::vector<double> all(static_cast<std::size_t>(copies.num_nodes()));
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = copies.share()[n] * of_initial[copies.initial()[n]];
  return all;
}
inline std::vector<double> summed(std::span<const double> of_copies, const NodeCopies& copies) {
  std::vector<double> all(static_cast<std::size_t>(copies.num_initial()));
  for (std::size_t n = 0; n < of_copies.size(); ++n) all[copies.initial()[n]] += of_copies[n];
  return all;
}

/// The copies that a list of present nodes lacks of these nodes.
inline std::vector<int> missing_copies(std::span<const int> nodes, const NodeCopies& copies) {
  std::vector<unsigned char> is_there(static_cast<std::size_t>(copies.num_nodes()));
  for (const int node : nodes) is_there[static_cast<std::size_t>(node)] = 1;
  std::vector<int> missing;
  for (const int node : nodes)
    for (const int copy : copies.of(copies.initial()[node]))
      if (!std::exchange(is_there[static_cast<std::size_t>(copy)], 1)) missing.push_back(copy);
  return missing;
}

/// Gives new nodes of a state the rows of those that they were split from, behind its present ones, which lie at
/// [first, end).
inline void insert_rows(PointArray& field, std::span<const int> split_from, Eigen::Index first, Eigen::Index end) {
  const PointArray before = field;
  const Eigen::Index count = std::ssize(split_from), behind = before.rows() - end;
  field.resize(before.rows() + count, 3);
  field.topRows(end) = before.topRows(end);
  for (Eigen::Index i = 0; i < count; ++i)
    field.row(end + i) = before.row(first + split_from[static_cast<std::size_t>(i)]);
  field.bottomRows(behind) = before.bottomRows(behind);
}

}  // namespace hexaplast::parts
