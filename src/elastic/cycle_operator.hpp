// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "state/linearization.hpp"

namespace hexaplast {

/// What multigrid cycles take for the stiffness of a body: elements with one rotation, as parallelepipeds. Their
/// product takes a quarter of the time, and conjugate gradients about as many iterations. Blocks with an element that
/// has no such shape, and those that gain nothing, keep their own coefficients.               theory.md sections 9.3
/// and 9.5
class CycleOperator final : public ChunkedOperator<float> {
 public:
  explicit CycleOperator(const Model& model);

  /// Of the positions that `at` holds, to which it refers from then on.
  void update(const Model& model, const Linearization& at);
  /// A copy of the Linearization of the latest update.
  void set_linearization(const Linearization& at) { at_ = &at; }

  const Partition& partition() const override { return simple_.partition(); }
  void add_product(int chunk, float factor, const float* p, float* Ap) const override;
  void add_diagonal(int chunk, float factor, float* diagonal) const override;

 private:
  template <class Visit>
  void visit_others(const Visit& visit) const;

  ElementOperator<float, Half> simple_;
  ElementOperator<float, float> rounded_;     // of others in double precision
  std::vector<unsigned char> is_simple_;      // per block
  std::vector<unsigned char> keeps_its_own_;  // per block: the opposite
  std::vector<unsigned char> is_thin_;        // per block
  const Linearization* at_ = nullptr;         // of the latest update
};

}  // namespace hexaplast
