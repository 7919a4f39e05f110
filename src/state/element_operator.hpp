// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "layout/chunked_operator.hpp"
#include "layout/partition.hpp"
#include "state/stored_element.hpp"

namespace hexaplast {

/// Bits of a 16-bit floating point number (1 sign, 5 exponent, 10 mantissa).
struct Half {
  std::uint16_t bits;
};

/// L = - df/dx of a body with its rotations held fixed, as coefficients of its elements: no matrix.
///                                                                                             theory.md section 9.3
/// Per block: [coefficient][element], a StoredElement each, general unless all of the block are parallelepipeds; or a
/// StoredOneRotation each. Lengths are in units of Model::length, so that the coefficients are of the order of 1 and
/// fit Coef.
/// T: numbers computed with; Coef: coefficients as stored.
template <class T, class Coef>
class ElementOperator final : public ChunkedOperator<T> {
 public:
  explicit ElementOperator(std::shared_ptr<const Partition> partition);

  const Partition& partition() const override { return *partition_; }
  void add_product(int chunk, T factor, const T* p, T* Ap) const override {
    add_product_of(nullptr, chunk, factor, p, Ap);
  }
  void add_diagonal(int chunk, T factor, T* diagonal) const override {
    add_diagonal_of(nullptr, chunk, factor, diagonal);
  }
  /// The same of the blocks whose entry is not 0.
  void add_product_of(const unsigned char* blocks, int chunk, T factor, const T* p, T* Ap) const;
  void add_diagonal_of(const unsigned char* blocks, int chunk, T factor, T* diagonal) const;

  /// Makes room for blocks of these kinds; has_coefficients: per block, not 0 where it has some, or null: all have.
  void resize(const std::vector<unsigned char>& is_general, const unsigned char* has_coefficients = nullptr);

  /// Of all elements of a block.
  std::span<Coef> coefficients(int block) { return {coef_.data() + first_[block], first_[block + 1] - first_[block]}; }
  std::span<const Coef> coefficients(int block) const {
    return {coef_.data() + first_[block], first_[block + 1] - first_[block]};
  }
  /// mu V / 8 and lambda V / 8 of an element, with V over Model::length squared.
  StoredNumbers<2, kBlock, T> weights(int block, int lane) {
    return {weight_.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane};
  }
  StoredNumbers<2, kBlock, const T> weights(int block, int lane) const {
    return {weight_.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane};
  }

  StiffnessKind kind;
  std::vector<unsigned char> is_general;  ///< per block

 private:
  std::shared_ptr<const Partition> partition_;
  std::vector<std::size_t> first_;  // per block, and the end: into coef_
  AlignedVector<Coef> coef_;
  AlignedVector<T> weight_;
};

}  // namespace hexaplast
