// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>

#include "layout/chunked_operator.hpp"
#include "layout/partition.hpp"
#include "state/history.hpp"

namespace hexaplast {

inline constexpr double kRegularisation = 1e-7;  ///< of P in eq. 31: keeps turns of a connected part definite

/// H + 1e-7 P of theory.md eq. 31, or P alone, element by element: the arms of the rotations that H leaves free, the
/// inverse of their inertia and a weight, per block [component][element of the block].
class AveragingOperator final : public ChunkedOperator<double> {
 public:
  explicit AveragingOperator(std::shared_ptr<const Partition> partition);

  const Partition& partition() const override { return *partition_; }
  void add_product(int chunk, double factor, const double* p, double* Ap) const override;
  void add_diagonal(int chunk, double factor, double* diagonal) const override;

  static constexpr int kArm = 0;                 ///< x - c: [corner][axis]
  static constexpr int kInertia = 3 * kCorners;  ///< xx yy zz yz zx xy of (B^T B)^-1
  static constexpr int kWeight = kInertia + 6;   ///< 1 where the element counts, otherwise 0
  static constexpr int kComponents = kWeight + 1;
  double* weights_of(int block) {
    return coef.data() + (static_cast<std::size_t>(block) * kComponents + kWeight) * kBlock;
  }

  bool projects = true;        ///< H; otherwise P
  AlignedVector<double> coef;  ///< [block][component][element]

 private:
  std::shared_ptr<const Partition> partition_;
};

/// What one pass over the elements of a chunk reads and writes.
struct FitPass {
  const Partition& partition;
  const double* plastic_rest;       ///< [m] slots
  const std::uint16_t* present;     ///< per block
  const ElementPoints* rest_shape;  ///< y, per element
  Mat3* rotation_map;               ///< Pi, per element: written
  double* coef;                     ///< AveragingOperator::coef: written but for the weights, unless null
  double* gradient;                 ///< [m] slots: t - (x - c) added, unless null
  double* misfit;                   ///< [m^2] per block: sum |t - (x - c)|^2
  double* size;                     ///< [m^2] per block: sum |t|^2, unless null
};

/// Best rotations, targets and misfits of the elements of a chunk.                                           eq. 30
void fit_elements(const FitPass& pass, int chunk);

}  // namespace hexaplast
