// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/parallel.hpp"
#include "layout/partition.hpp"

namespace hexaplast {

/// A symmetric positive semi-definite operator L on nodal vectors of the kernels (Partition), applied chunk by chunk.
template <class T>
class ChunkedProduct {
 public:
  virtual ~ChunkedProduct() = default;
  virtual const Partition& partition() const = 0;

  /// Ap += factor L p for the elements of one chunk. p: ghosts up to date. Writes the slots of this chunk alone; what
  /// belongs to nodes of other chunks is left in its ghosts.
  virtual void add_product(int chunk, T factor, const T* p, T* Ap) const = 0;
};

/// The same with its diagonal.
template <class T>
class ChunkedOperator : public ChunkedProduct<T> {
 public:
  /// diagonal += factor diag(L) for the elements of one chunk, written likewise.
  virtual void add_diagonal(int chunk, T factor, T* diagonal) const = 0;
};

/// slots = factor diag(L) at the nodes of a body, 0 elsewhere. `slots` has their number.
template <class T>
void find_diagonal(const ChunkedOperator<T>& op, T factor, AlignedVector<T>& slots) {
  const Partition& partition = op.partition();
  std::ranges::fill(slots, T(0));
  parallel_for(partition.num_chunks, [&](int chunk) { op.add_diagonal(chunk, factor, slots.data()); });
  parallel_for(partition.num_chunks, [&](int chunk) { reduce_ghosts(partition, chunk, slots.data()); });
}

}  // namespace hexaplast
