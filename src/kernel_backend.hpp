// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>

#include "backend.hpp"
#include "elastic/exact_product.hpp"
#include "elastic/hierarchy.hpp"
#include "plastic/flow.hpp"

namespace hexaplast {

/// The element kernels, chunk by chunk.
class KernelBackend : public Backend {
 public:
  KernelBackend(const Model& of, History& its_history, const std::vector<BranchStep>& its_branches);

  void linearize(ConstPoints x) override { linearize(x, !skips_screening && branches.empty()); }
  void add_force(Points f) const override;
  void add_product(double factor, ConstPoints dx, Points df) const override;
  void add_stiffness_blocks(double factor, BlockMatrix& K) const override;
  void add_operator(double factor, MatrixFreeSystem& system) override;
  double energy(ConstPoints x) override;
  FlowReport flow(ConstPoints x, double dt) override;
  void find_fields(ConstPoints x, const EvaluatedFields& fields) override;
  const Recovery& recovery() const override { return at.recovery; }
  const Recovery& find_recovery(ConstPoints x) override;
  void forget() override;
  void renew() override;

  Linearization at;
  bool skips_screening = false;  ///< most elements flowed in the latest plastic step: screening first would be in vain

 protected:
  Tear* tear() { return flow_ && flow_->tear ? &*flow_->tear : nullptr; }
  /// That are to open after a step in which tear()->broken have passed their limits.
  std::vector<int> torn_faces(ConstPoints x);

 private:
  /// The latest energy, and what has led to it.
  struct Evaluated {
    std::vector<double> energy;       // [J] per block
    std::vector<std::uint16_t> thin;  // per block, as Linearization::thin
    Recovery recovery;
    double sum = 0;     // [J]
    PointArray x;       // [m]
    long version = -1;  // History::version that it belongs to
  };

  void make_flow();
  void linearize(ConstPoints x, bool screens);
  void update_material();
  void set_positions(ConstPoints x);
  void take_history(int block);
  void take_flow();
  template <class Visit>
  void for_each_block_at(ConstPoints x, std::span<const BranchStep> steps, const Visit& visit);

  std::optional<FlowWorkspace> flow_;                // where the history changes
  mutable SlotScratch slots_;                        // of solvers, and of all verbs
  mutable AlignedVector<float> argument_, product_;  // of products in single precision
  Evaluated evaluated_;
  DoublePrecisionOperator exact_;              // of mixed precision
  std::optional<ElementHierarchy> hierarchy_;  // made when a solver first asks for levels
};

}  // namespace hexaplast
