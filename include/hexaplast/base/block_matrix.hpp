// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Square sparse matrix of 3x3 blocks, assembled by adding. The pattern grows with the first assembly and is kept by
/// clear(), so that later assemblies only add numbers; drop_unused() then leaves the pattern of the latest one,
/// whatever was assembled before. What names a node throws InputError where that does not exist.
class BlockMatrix {
 public:
  explicit BlockMatrix(int num_nodes = 0);

  /// Of the present range.
  int num_nodes() const { return num_nodes_; }

  /// From now on nodes are counted from `first_node`, and there are num_nodes of them: for those who know a part of a
  /// system alone. row and clear are of the whole matrix always.
  void set_range(int first_node, int num_nodes);
  void set_whole_range() { set_range(0, static_cast<int>(rows_.size())); }

  /// Adds a block at (row, column). Both triangles are stored; the caller adds a symmetric matrix symmetrically.
  void add(int row, int column, const Mat3& block);

  /// Terms whose blocks would be dense, which only products have: the blocks are near the matrix, but not all of it.
  void leave_out() { leaves_out_ = true; }
  bool leaves_out() const { return leaves_out_; }

  /// All blocks to zero, and nothing left out; the pattern stays.
  void clear();

  /// Takes out the blocks to which nothing was added since clear().
  void drop_unused();

  /// Empties row and column of one degree of freedom (axis 0..2 of a node) and puts 1 on its diagonal: x there solves
  /// to b.
  void pin(int node, int axis);

  struct Entry {
    int column;
    Mat3 block;
  };
  const std::vector<Entry>& row(int node) const;  ///< ascending columns

  /// Grows whenever blocks come or go, so that a factorisation knows when its symbolic part is old.
  long pattern_version() const { return pattern_version_; }

 private:
  struct Row {
    std::vector<Entry> entries;
    std::vector<unsigned char> is_used;  // per entry: something was added since clear()
  };
  std::vector<Row> rows_;
  int first_node_ = 0, num_nodes_ = 0;  // of the range
  bool leaves_out_ = false;
  long num_unused_ = 0;  // entries
  long pattern_version_ = 0;
};

}  // namespace hexaplast
