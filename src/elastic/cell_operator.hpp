// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>

#include "layout/chunked_operator.hpp"
#include "layout/partition.hpp"

namespace hexaplast {

/// The stiffness of the cells of a coarse mesh. A cell is a hexahedron whose eight samples stand for its eight
/// children: gradients and rotations are those of the cell; moduli, and the Gm of isolated rest shapes, those of the
/// child.
///
/// Kept is the matrix of each cell over the 21 numbers of its modes (ModeLanes), symmetric, in single precision: cells
/// are few, and a product is the fastest that way.                                              theory.md section 9.5
class CellOperator final : public ChunkedOperator<float> {
 public:
  static constexpr int kSize = 3 * (kCorners - 1);
  static constexpr int kEntries = kSize * (kSize + 1) / 2;  ///< of the lower triangle, column by column

  /// Of the cells of a partition, which stays as long.
  explicit CellOperator(std::shared_ptr<const Partition> partition);

  const Partition& partition() const override { return *partition_; }
  void add_product(int chunk, float factor, const float* p, float* Ap) const override;
  void add_diagonal(int chunk, float factor, float* diagonal) const override;

  /// The matrices at these positions [m], in slots, from the moduli. mean_plastic: Gm of the children,
  /// [block][child][kMeanPlastic][cell], or null: 1. length [m]: Model::length. Cells that lie inside out have neither
  /// matrix nor moduli.
  void update(const double* plastic_rest, const double* current, const float* mean_plastic, double length);

  /// mu V / L^2 or lambda V / L^2 of a child: V its volume, L Model::length.
  enum Modulus { kMu, kLambda };
  float& modulus(int place, int child, Modulus which) { return moduli_[index(place, child, which)]; }
  float modulus(int place, int child, Modulus which) const { return moduli_[index(place, child, which)]; }

 private:
  static std::size_t index(int place, int child, Modulus which) {
    return ((static_cast<std::size_t>(place / kBlock) * kCorners + child) * 2 + which) * kBlock + place % kBlock;
  }

  std::shared_ptr<const Partition> partition_;
  AlignedVector<float> moduli_;    // [block][child][mu, lambda][cell]
  AlignedVector<float> matrices_;  // [block][kEntries][cell]
};

}  // namespace hexaplast
