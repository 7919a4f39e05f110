// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/solve/implicit_euler.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {

/// The components of a node and below, seen as one mechanical system: sums over masses and force fields, in the order
/// of the scene.
class NodeSystem final : public MechanicalSystem {
 public:
  /// Throws InputError unless there is exactly one mechanical state.
  explicit NodeSystem(scene::Node& node);

  int num_nodes() const override { return state_->num_nodes(); }
  void compute_force(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override;
  bool to_kernels(const OperatorFactors& factors, KernelSystem& system) const override;
  void project(Points field) const override;
  void pin(BlockMatrix& A) const override;

  scene::MechanicalState& state() const { return *state_; }
  bool has_mass() const { return !masses_.empty(); }
  double kinetic_energy() const;           ///< [J]
  void project_motion(double time) const;  ///< applies prescribed motion to the state

 private:
  scene::Node& node_;
  scene::MechanicalState* state_ = nullptr;
  std::vector<scene::Mass*> masses_;
  std::vector<scene::ForceField*> force_fields_;
  std::vector<scene::ProjectiveConstraint*> constraints_;
};

}  // namespace hexaplast::components
