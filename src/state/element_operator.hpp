// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hexaplast/layout/chunked_operator.hpp"
#include "layout/partition.hpp"

namespace hexaplast {

/// Bits of a 16-bit floating point number (1 sign, 5 exponent, 10 mantissa).
struct Half {
  std::uint16_t bits;
};

/// Numbers of one block of coefficients: C_i of all samples, or C_i, R_i and h.
inline constexpr std::size_t kBoxCoefficients = 9 * kCorners * kBlock;
inline constexpr std::size_t kGeneralCoefficients = (9 + 9 + 3) * kCorners * kBlock;

/// L = - df/dx of a body with its rotations held fixed, as coefficients of its elements: no matrix.
///                                                                                             theory.md section 9.3
/// Per block of elements, [component][element of the block]: C_i = J_i^-1 R_i^T / 2 at the eight samples (8 x 9), and
/// unless all elements of the block are parallelepipeds R_i (8 x 9) and h (8 x 3). Weights: mu V / 8 and lambda V / 8.
/// Lengths are in units of Model::length, so that the coefficients are of the order of 1 and fit Coef.
/// T: numbers computed with; Coef: coefficients as stored.
template <class T, class Coef>
class ElementOperator final : public ChunkedOperator<T> {
 public:
  explicit ElementOperator(std::shared_ptr<const Partition> partition);

  const Partition& partition() const override { return *partition_; }
  void add_product(int chunk, T factor, const T* p, T* Ap) const override;
  void add_diagonal(int chunk, T factor, T* diagonal) const override;

  /// Makes room for blocks of these kinds.
  void resize(const std::vector<unsigned char>& is_general);

  /// Bytes that are kept, all of which one application reads.
  std::size_t bytes() const { return coef.size() * sizeof(Coef) + weight.size() * sizeof(T); }

  double corner_weight = 0.5;             ///< RestOperator::corner_weight
  bool per_sample = false;                ///< weights differ between the samples of an element
  std::vector<unsigned char> is_general;  ///< per block
  std::vector<std::size_t> offset;        ///< per block: into coef
  AlignedVector<Coef> coef;
  AlignedVector<T> weight;  ///< [block][mu, lambda][element], or [block][sample][mu, lambda][element]

 private:
  std::shared_ptr<const Partition> partition_;
};

}  // namespace hexaplast
