// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/base/block_matrix.hpp"

#include <algorithm>

namespace hexaplast {

BlockMatrix::BlockMatrix(int num_nodes) : rows_(num_nodes) {}

void BlockMatrix::add(int row, int column, const Mat3& block) {
  auto& entries = rows_[row];
  auto at = std::lower_bound(entries.begin(), entries.end(), column,
                             [](const Entry& entry, int wanted) { return entry.column < wanted; });
  if (at == entries.end() || at->column != column) {
    at = entries.insert(at, {column, Mat3::Zero()});
    ++pattern_version_;
  }
  at->block += block;
}

void BlockMatrix::clear() {
  for (auto& entries : rows_)
    for (Entry& entry : entries) entry.block.setZero();
}

void BlockMatrix::pin(int node, int axis) {
  // the pattern is symmetric, so the blocks of the node's column stand in the rows that its own row names
  for (Entry& entry : rows_[node]) {
    entry.block.row(axis).setZero();
    auto& mirrored = rows_[entry.column];
    const auto at = std::lower_bound(mirrored.begin(), mirrored.end(), node,
                                     [](const Entry& other, int wanted) { return other.column < wanted; });
    if (at != mirrored.end() && at->column == node) at->block.col(axis).setZero();
  }
  Mat3 one = Mat3::Zero();
  one(axis, axis) = 1;
  add(node, node, one);
}

}  // namespace hexaplast
