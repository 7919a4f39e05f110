// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/node_blocks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solve/constants.hpp"

namespace hexaplast {

namespace {

/// The nearest positive semi-definite matrix: rows of a matrix that is one may sum up to something else.
Mat3 without_negative_part(const Mat3& block) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(block);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

// D + block = D^1/2 (I + Q L Q^T) D^1/2
BlockAxes::BlockAxes(const Vec3& D, const Mat3& block) {
  Vec3 root, counts;
  for (int i = 0; i < 3; ++i) {
    root[i] = std::sqrt(D[i] > 0 ? D[i] : kFractionOfBlock * block.trace());
    is_coupled[i] = !block.row(i).isZero(0);
    counts[i] = is_coupled[i] ? 1 : 0;
  }
  const Vec3 inverse_root = root.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inverse_root.asDiagonal() * block * inverse_root.asDiagonal());
  stiffness = eigen.eigenvalues().cwiseMax(0);
  axes = inverse_root.cwiseProduct(counts).asDiagonal() * eigen.eigenvectors();
  dual = root.cwiseProduct(counts).asDiagonal() * eigen.eigenvectors();
}

void LumpedTerms::find(const MatrixFreeSystem& system, std::span<const NodeGroup> groups) {
  const Eigen::Index num_nodes = system.diagonal.rows();
  diagonal_ = system.diagonal;
  blocks_.clear();
  ties_.assign(groups.size(), false);
  for (const NodalTerm& other : system.others) other.add_diagonal(diagonal_);
  if (std::ranges::all_of(system.others, [](const NodalTerm& other) { return other.op->has_diagonal(); })) return;
  for (int axis = 0; axis < 3; ++axis) {
    unit_.setZero(num_nodes, 3);
    columns_[axis].setZero(num_nodes, 3);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const NodeGroup& group = groups[g];
      group.rows(unit_).col(axis) = group.rows(system.constraints.free).col(axis).cast<double>();
      product_.setZero(num_nodes, 3);
      for (const NodalTerm& other : system.others)
        if (!other.op->has_diagonal()) other.add_product(unit_, product_);
      group.rows(columns_[axis]) = group.rows(product_);
      for (std::size_t later = g + 1; later < groups.size(); ++later)
        ties_[g] = ties_[g] || !groups[later].rows(product_).isZero(0);
    }
  }
  for (int n = 0; n < num_nodes; ++n) {
    Mat3 block;
    for (int axis = 0; axis < 3; ++axis) block.col(axis) = columns_[axis].row(n).transpose();
    const Vec3 is_free = system.constraints.free.row(n).transpose().cast<double>();
    block = is_free.asDiagonal() * Mat3((block + block.transpose()) / 2) * is_free.asDiagonal();
    if (block.isDiagonal(0))
      diagonal_.row(n) += block.diagonal().cwiseMax(0).transpose();
    else if (block = without_negative_part(block); block.trace() > 0)
      blocks_.push_back({n, block});
  }
}

template <class T>
void SlotBlocks<T>::setup(const Partition& partition, std::span<const NodeBlock> blocks, AlignedVector<T>& inverse) {
  clear();
  for (const NodeBlock& block : blocks) add(partition.slot_of_node[block.node], block.block);
  complete(partition, inverse);
}

template <class T>
void SlotBlocks<T>::complete(const Partition& partition, AlignedVector<T>& inverse) {
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.slot < b.slot; });
  first_.assign(1, 0);
  for (int chunk = 0; chunk < partition.num_chunks; ++chunk) {
    int k = first_.back();
    while (k < static_cast<int>(entries_.size()) && entries_[k].slot < partition.first_node[chunk + 1]) ++k;
    first_.push_back(k);
  }
  for (Entry& entry : entries_) {
    T* of_node = inverse.data() + 4 * static_cast<std::size_t>(entry.slot);
    Vec3 D;
    for (int i = 0; i < 3; ++i) D[i] = of_node[i] > T(0) ? 1 / static_cast<double>(of_node[i]) : 0;
    entry = entry_of(entry.slot, D, entry.block);
    for (int i = 0; i < 3; ++i)
      if (!entry.block.row(i).isZero(0)) of_node[i] = T(0);
  }
}

template <class T>
typename SlotBlocks<T>::Entry SlotBlocks<T>::entry_of(int slot, const Vec3& D, const Mat3& block) {
  const BlockAxes of(D, block);
  const Vec3 compliance = of.compliance(), fraction = Vec3::Ones() - compliance;
  Entry entry{.slot = slot, .block = block};
  entry.restricted = of.dual * fraction.asDiagonal() * of.dual.transpose();
  entry.axes = of.axes.template cast<T>();
  entry.dual = of.dual.template cast<T>();
  for (int i = 0; i < 3; ++i) {
    const bool is_rigid = of.stiffness[i] > kRigid;
    entry.stiffness[i] = is_rigid ? T(0) : static_cast<T>(of.stiffness[i]);
    entry.inverse[i] = is_rigid ? T(0) : static_cast<T>(compliance[i]);
    entry.rigid[i] = is_rigid ? static_cast<T>(compliance[i]) : T(0);
    entry.loss[i] = is_rigid ? T(1) : static_cast<T>(fraction[i]);
  }
  return entry;
}

template <class T>
void SlotBlocks<T>::set_coarse(int k) {
  Entry& entry = entries_[k];
  entry.restricted = entry.block;
  for (int i = 0; i < 3; ++i) entry.loss[i] = entry.inverse[i] > T(0) ? T(0) : T(1);
}

template class SlotBlocks<double>;
template class SlotBlocks<float>;

}  // namespace hexaplast
