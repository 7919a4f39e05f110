// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/block_matrix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/require.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {

BlockMatrix::BlockMatrix(int num_nodes) : rows_(num_nodes), num_nodes_(num_nodes) {}

void BlockMatrix::set_range(int first_node, int num_nodes) {
  if (first_node < 0 || num_nodes < 0 || num_nodes > std::ssize(rows_) - first_node)
    throw InputError(fmt::format("BlockMatrix::set_range: nodes [{}, {}) must lie in [0, {})", first_node,
                                 std::int64_t{first_node} + num_nodes, rows_.size()));
  first_node_ = first_node;
  num_nodes_ = num_nodes;
}

void BlockMatrix::add(int row, int column, const Mat3& block) {
  require_nodes("BlockMatrix::add", std::array{row, column}, num_nodes_);
  row += first_node_;
  column += first_node_;
  auto& [entries, is_used] = rows_[row];
  auto at = std::lower_bound(entries.begin(), entries.end(), column,
                             [](const Entry& entry, int wanted) { return entry.column < wanted; });
  const auto index = at - entries.begin();
  if (at == entries.end() || at->column != column) {
    at = entries.insert(at, {column, Mat3::Zero()});
    is_used.insert(is_used.begin() + index, 1);
    ++pattern_version_;
  } else if (!is_used[index]) {
    is_used[index] = 1;
    --num_unused_;
  }
  at->block += block;
}

const std::vector<BlockMatrix::Entry>& BlockMatrix::row(int node) const {
  require_nodes("BlockMatrix::row", std::array{node}, std::ssize(rows_));
  return rows_[node].entries;
}

void BlockMatrix::clear() {
  num_unused_ = 0;
  leaves_out_ = false;
  for (auto& [entries, is_used] : rows_) {
    for (Entry& entry : entries) entry.block.setZero();
    std::fill(is_used.begin(), is_used.end(), 0);
    num_unused_ += static_cast<long>(entries.size());
  }
}

void BlockMatrix::drop_unused() {
  if (num_unused_ == 0) return;
  for (auto& [entries, is_used] : rows_) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < entries.size(); ++k)
      if (is_used[k]) entries[kept++] = entries[k];
    entries.resize(kept);
    is_used.assign(kept, 1);
  }
  num_unused_ = 0;
  ++pattern_version_;
}

void BlockMatrix::pin(int node, int axis) {
  require_nodes("BlockMatrix::pin", std::array{node}, num_nodes_);
  if (axis < 0 || axis > 2) throw InputError(fmt::format("BlockMatrix::pin: axis {} must lie in [0, 3)", axis));
  const int own = first_node_ + node;
  // the pattern is symmetric, so the blocks of the node's column stand in the rows that its own row names
  for (Entry& entry : rows_[own].entries) {
    entry.block.row(axis).setZero();
    auto& mirrored = rows_[entry.column].entries;
    const auto at = std::lower_bound(mirrored.begin(), mirrored.end(), own,
                                     [](const Entry& other, int wanted) { return other.column < wanted; });
    if (at != mirrored.end() && at->column == own) at->block.col(axis).setZero();
  }
  Mat3 one = Mat3::Zero();
  one(axis, axis) = 1;
  add(node, node, one);
}

}  // namespace hexaplast
