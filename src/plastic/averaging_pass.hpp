// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "layout/chunked_operator.hpp"
#include "plastic/averaging.hpp"

namespace hexaplast {

/// H + 1e-7 P of theory.md eq. 31, or P alone, element by element: the arms of the rotations that H leaves free, the
/// inverse of their inertia and a weight, per block [component][element of the block].
template <class T>
class AveragingOperator final : public ChunkedOperator<T> {
 public:
  explicit AveragingOperator(std::shared_ptr<const Partition> partition);

  const Partition& partition() const override { return *partition_; }
  const std::shared_ptr<const Partition>& shared_partition() const { return partition_; }
  void add_product(int chunk, T factor, const T* p, T* Ap) const override;
  void add_diagonal(int chunk, T factor, T* diagonal) const override;

  static constexpr int kArm = 0;                 ///< x - c: [corner][axis]
  static constexpr int kInertia = 3 * kCorners;  ///< xx yy zz yz zx xy of (B^T B)^-1
  static constexpr int kWeight = kInertia + 6;   ///< of the element: 1, or that of the elements that a cell stands for
  static constexpr int kComponents = kWeight + 1;
  bool projects = true;   ///< H; otherwise P
  AlignedVector<T> coef;  ///< [block][component][element]

 private:
  std::shared_ptr<const Partition> partition_;
};

/// What one pass over the elements of a chunk reads and writes.
template <class T>
struct FitPass {
  const Partition& partition;
  const double* plastic_rest;       ///< [m] slots
  const std::uint16_t* present;     ///< per block
  const ElementPoints* rest_shape;  ///< y, per element
  Mat3* rotation_map;               ///< Pi, per element: written
  T* coef;                          ///< AveragingOperator::coef: written but for the weights, unless null
  double* gradient;                 ///< [m] slots: t - (x - c) added, unless null
  double* misfit;                   ///< [m^2] per block: sum |t - (x - c)|^2
  double* size;                     ///< [m^2] per block: sum |t|^2, unless null
};

/// Best rotations, targets and misfits of the elements of a chunk.                                           eq. 30
template <class T>
void fit_elements(const FitPass<T>& pass, int chunk);

/// The same on the cells of a coarse mesh, that fit. position: [m] slots; weight: per cell.
void fit_cells(const double* position, const float* weight, int chunk, AveragingOperator<float>& op);

}  // namespace hexaplast
