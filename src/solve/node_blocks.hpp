// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/layout/linear_system.hpp"
#include "layout/partition.hpp"

namespace hexaplast {

/// A symmetric positive semi-definite block on the diagonal of a matrix over nodes, which couples the axes of a node.
struct NodeBlock {
  int node = 0;
  Mat3 block = Mat3::Zero();
};

/// A symmetric positive semi-definite matrix over nodes without entries between two of them.
struct NodalPart {
  const PointArray& diagonal;                ///< num_nodes x 3
  const NodeMask& free;                      ///< num_nodes x 3: 1 where free, 0 where fixed
  std::span<const NodeBlock> blocks = {};    ///< beside the diagonal; ascending nodes, 0 where fixed
  const PointArray* own_diagonal = nullptr;  ///< the part of the diagonal that is not of other terms; null: all of it
};

/// A block B beside a diagonal D, along the three directions a that both have in common: a.D a' = 0 = a.B a', a.D a =
/// 1, a.B a = stiffness. Where D is 0, as without elements and mass, a fraction of the block takes its place.
struct BlockAxes {
  BlockAxes(const Vec3& D, const Mat3& block);
  Mat3 axes;                       ///< a, in columns; 0 in the rows in which the block is
  Mat3 dual;                       ///< D a, in columns; 0 in these rows too: a direction is told by dual^T axes = 1
  Vec3 stiffness;                  ///< relative to D
  std::array<bool, 3> is_coupled;  ///< rows of the block that are not 0

  /// (D + block)^-1, relative to D^-1
  Vec3 compliance() const { return (stiffness.array() + 1).inverse(); }
};

/// What stands for the terms beside the bodies in a preconditioner: their rows, summed over the free nodes. That is the
/// same where they tie nodes to the ground, as obstacles and grips do; it is the lumped mass of a consistent one, the
/// fraction of each node in what points tie that follow the nodes, and nothing of a spring between two free nodes,
/// which does not resist where they move together.
///
/// Where terms tie groups of nodes to each other, the rows of a group are summed over the nodes of this group and of
/// those before it: springs to a group behind it are as springs to the ground.
class LumpedTerms {
 public:
  /// The diagonal of the system and that of the terms; `system` has terms. groups: all nodes, in one or several.
  void find(const MatrixFreeSystem& system, std::span<const NodeGroup> groups);

  /// Whether terms tie a group to one behind it.
  bool ties(std::size_t group) const { return ties_[group]; }

  const PointArray& diagonal() const { return diagonal_; }          ///< num_nodes x 3
  const std::vector<NodeBlock>& blocks() const { return blocks_; }  ///< of nodes whose axes are coupled

 private:
  PointArray diagonal_, unit_;
  std::array<PointArray, 3> columns_;
  PointArray product_;
  std::vector<bool> ties_;
  std::vector<NodeBlock> blocks_;
};

/// The blocks of a NodalPart in slots of a partition. Directions in which a block is far stiffer than D are rigid, as
/// fixed degrees of freedom are: cycles leave them out, as the rounding of such a stiffness would be one in the other
/// directions, and they are divided by their own stiffness beside the cycles.
template <class T>
class SlotBlocks {
 public:
  using Block = Eigen::Matrix<T, 3, 3>;
  using Vec = Eigen::Matrix<T, 3, 1>;
  struct Entry {
    int slot = 0;
    Mat3 block = Mat3::Zero();                // as it was added
    Mat3 restricted = block;                  // for coarser meshes: the block itself, or D and it one behind the other
    Block axes = Block::Zero(), dual = axes;  // BlockAxes
    Vec stiffness = Vec::Zero(), inverse = stiffness, rigid = inverse;  // along the axes: of the block; 1 / (1 + that),
                                                                        // where not rigid, and where it is
    Vec loss = Vec::Zero();  // how much of what coarse nodes do along an axis does not reach the node
  };

  /// Of a node whose matrix without the block has the diagonal D.
  static Entry entry_of(int slot, const Vec3& D, const Mat3& block);

  bool empty() const { return entries_.empty(); }
  const std::vector<Entry>& entries() const { return entries_; }

  void clear() { entries_.clear(); }
  void add(int slot, const Mat3& block) { entries_.push_back({.slot = slot, .block = block}); }

  /// Those of a fine mesh, complete.
  void setup(const Partition& partition, std::span<const NodeBlock> blocks, AlignedVector<T>& inverse);

  /// After the last of the blocks. `inverse`: 1 / D of the matrix without them, which becomes 0 where a block takes its
  /// place: the blocks' own inverse is that of D + block.
  void complete(const Partition& partition, AlignedVector<T>& inverse);

  /// At an entry's node lies one of the coarser mesh: it goes where that does, but for rigid directions.
  void set_coarse(int entry);

  /// to += factor block from, for the nodes of a chunk; without rigid directions.
  void add_product(int chunk, T factor, const AlignedVector<T>& from, AlignedVector<T>& to) const {
    for_each(chunk, [&](const Entry& entry) {
      vec(to, entry) += entry.dual * (factor * entry.stiffness).cwiseProduct(entry.dual.transpose() * vec(from, entry));
    });
  }

  /// to += factor (D + block)^-1 from, without rigid directions.
  void add_inverse_product(int chunk, T factor, const AlignedVector<T>& from, AlignedVector<T>& to) const {
    for_each(chunk, [&](const Entry& entry) {
      vec(to, entry) += entry.axes * (factor * entry.inverse).cwiseProduct(entry.axes.transpose() * vec(from, entry));
    });
  }

  /// The same of the rigid directions.
  void add_rigid_product(int chunk, const AlignedVector<T>& from, AlignedVector<T>& to) const {
    for_each(chunk, [&](const Entry& entry) {
      vec(to, entry) += entry.axes * entry.rigid.cwiseProduct(entry.axes.transpose() * vec(from, entry));
    });
  }

  /// x, what the nodes of a coarser mesh do, becomes what these nodes do along: (D + block)^-1 D x where a node hangs
  /// between coarse ones.
  void prolong(int chunk, AlignedVector<T>& x) const {
    for_each(chunk, [&](const Entry& entry) {
      vec(x, entry) -= entry.axes * entry.loss.cwiseProduct(entry.dual.transpose() * vec(x, entry)).eval();
    });
  }

  /// The transposed, on r; what r was goes into `before`.
  void restrict_residual(int chunk, AlignedVector<T>& r, AlignedVector<T>& before) const {
    for_each(chunk, [&](const Entry& entry) {
      vec(before, entry) = vec(r, entry);
      vec(r, entry) -= entry.dual * entry.loss.cwiseProduct(entry.axes.transpose() * vec(r, entry)).eval();
    });
  }

  /// to = from at the nodes of a chunk that have blocks.
  void copy(int chunk, const AlignedVector<T>& from, AlignedVector<T>& to) const {
    for_each(chunk, [&](const Entry& entry) { vec(to, entry) = vec(from, entry); });
  }

 private:
  template <class Call>
  void for_each(int chunk, const Call& call) const {
    for (int k = first_[chunk]; k < first_[chunk + 1]; ++k) call(entries_[k]);
  }
  static auto vec(const AlignedVector<T>& of, const Entry& entry) {
    return Eigen::Map<const Vec>(of.data() + 4 * static_cast<std::size_t>(entry.slot));
  }
  static auto vec(AlignedVector<T>& of, const Entry& entry) {
    return Eigen::Map<Vec>(of.data() + 4 * static_cast<std::size_t>(entry.slot));
  }

  std::vector<Entry> entries_;  // ascending slots
  std::vector<int> first_;      // per chunk, and one more
};

}  // namespace hexaplast
