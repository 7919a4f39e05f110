// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/solve/implicit_euler.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {

/// The components of a node and below, seen as one mechanical system over the one state that follows no other: sums
/// over masses and force fields, in the order of the scene. What acts on a state that follows is carried up by its
/// mapping.
class NodeSystem final : public MechanicalSystem {
 public:
  /// Throws InputError unless there is exactly one independent state, which all others follow, and all constraints act
  /// on it.
  explicit NodeSystem(scene::Node& node);
  NodeSystem(const NodeSystem&) = delete;

  int num_nodes() const override { return state().num_nodes(); }
  void compute_force(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override;
  bool describe(const OperatorFactors& factors, MatrixFreeSystem& system) const override;
  void add_load(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_load_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  bool add_mass_diagonal(Points diagonal) const override;
  void prescribe(double time, Points x, Points v) const override;
  void project(Points field) const override;
  void pin(BlockMatrix& A) const override;

  scene::MechanicalState& state() const { return *layers_.front().state; }

  /// move(x, v) with the positions and velocities of the independent state.
  template <class Move>
  auto advance(const Move& move) {
    return move(state().positions(), state().velocities());
  }

  bool has_mass() const;
  double kinetic_energy() const;           ///< [J]
  bool has_elastic_energy() const;         ///< whether the forces of all bodies have a potential
  double elastic_energy() const;           ///< [J] of the bodies that have one
  double recovery_work() const;            ///< [J] of the bodies
  double highest_frequency() const;        ///< [rad/s] about that of the bodies' fastest vibration; 0: nothing vibrates
  void project_motion(double time) const;  ///< applies prescribed motion to the state, and lets the others follow
  void follow() const;                     ///< puts the states that follow where the independent one takes them

 private:
  /// A state and what acts on it.
  struct Layer {
    scene::MechanicalState* state = nullptr;
    const scene::Mapping* mapping = nullptr;  // null: the independent state
    std::size_t above = 0;                    // layer that it follows; lies before this one
    std::vector<scene::Mass*> masses = {};
    std::vector<scene::ForceField*> force_fields = {};

    bool is_loaded = false;  // of those that follow: something acts on it, or on one that follows it

    // of the matrix of describe: what its kernels do not know
    std::vector<const scene::Mass*> other_masses = {};
    std::vector<const scene::ForceField*> other_fields = {};
    bool has_others = false;  // of those that follow: something of the matrix is there, or at one that follows it

    // scratch of the states that follow
    PointArray x = {}, v = {}, f = {};
    BlockMatrix blocks = BlockMatrix();
  };

  /// What of the scene a sum is over: everything, what is neither a body nor a mass, but weight is, or what the kernels
  /// of the latest matrix do not know.
  enum class Over { kAll, kLoads, kOthers };

  class Others final : public NodalOperator {
   public:
    explicit Others(const NodeSystem& system) : system_(&system) {}
    void add_product(ConstPoints p, Points Fp) const override;
    OperatorFactors factors;

   private:
    const NodeSystem* system_;
  };

  void add_layers(scene::Node& node);
  void add_force(Over over, double time, ConstPoints x, ConstPoints v, Points f) const;
  void add_force(Over over, const Layer& layer, double time, ConstPoints x, ConstPoints v, Points f) const;
  void add_product(Over over, const OperatorFactors& factors, ConstPoints dx, Points df) const;
  static void add_product(Over over, const Layer& layer, const OperatorFactors& factors, ConstPoints dx, Points df);
  void find_others() const;
  static void add_blocks(const Layer& layer, const OperatorFactors& factors, BlockMatrix& A);

  scene::Node& node_;
  mutable std::vector<Layer> layers_;  // the independent state first; mutable for its scratch
  mutable Others others_ = Others(*this);
  std::vector<scene::ProjectiveConstraint*> constraints_;
};

}  // namespace hexaplast::components
