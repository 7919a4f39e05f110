// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/solve/implicit_euler.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {

/// The components of a node and below, seen as one mechanical system over the states that follow no other, one behind
/// the other in the order of the scene: sums over masses and force fields. What acts on a state that follows is carried
/// up by its mapping.
class NodeSystem final : public MechanicalSystem {
 public:
  /// Throws InputError unless there is an independent state, all others follow one, and constraints act on independent
  /// ones.
  explicit NodeSystem(scene::Node& node);
  NodeSystem(const NodeSystem&) = delete;

  int num_nodes() const override { return num_nodes_; }
  void compute_force(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override;
  bool describe(const OperatorFactors& factors, MatrixFreeSystem& system) const override;
  void add_load(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_load_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  bool release(double time, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end, Points force,
               Points product) override;
  void prescribe(double time, Points x, Points v) const override;
  void project(Points field) const override;
  void pin(BlockMatrix& A) const override;

  /// Of all independent states.
  const PointArray& positions();   ///< valid until the next call
  const PointArray& velocities();  ///< likewise

  /// move(x, v) with the positions and velocities of all independent states, which then have what it made of them.
  template <class Move>
  auto advance(const Move& move) {
    if (constraints_changed_) require_commuting();
    if (num_roots_ == 1) {
      auto result = move(root(0).state->positions(), root(0).state->velocities());
      return result;
    }
    gather();
    auto result = move(x_, v_);
    scatter();
    return result;
  }

  /// Constraints have changed: whether they go together is checked when it advances next, after all of them have.
  void constraints_changed() { constraints_changed_ = true; }

  /// The rows of a field of the system that belong to an independent state of it.
  ConstPoints rows_of_state(const scene::MechanicalState& state, ConstPoints of_all) const;

  /// Rejects the scene, naming what no assembled matrix has: constraints that couple nodes, and forces between states
  /// of which one follows another one. `why`: who asks for a matrix.
  void require_matrix(const std::string& why) const;

  /// Throws InputError, naming the first independent state on which no mass acts, nor on those that follow it.
  void require_mass() const;
  double kinetic_energy() const;  ///< [J]
  double elastic_energy() const;  ///< [J] of the bodies
  double recovery_work() const;   ///< [J] of the bodies

  /// Whether something damps explicitly (ForceField::damps_explicitly), and f = the forces of its damping [N].
  bool damps_explicitly() const;
  void damping_force(double time, ConstPoints x, ConstPoints v, Points f);
  void divide_by_mass(Points field) const;  ///< field = M^-1 field; zero where nodes have no mass of their own
  scene::Component& strongest_damper(double time) const;  ///< of those, at the moment

  double highest_frequency() const;        ///< [rad/s] about that of the bodies' fastest vibration; 0: nothing vibrates
  void project_motion(double time) const;  ///< applies prescribed motion to the states, and lets the others follow
  void follow() const;                     ///< puts the states that follow where the independent ones take them

 private:
  /// A state and what acts on it.
  struct Layer {
    scene::MechanicalState* state = nullptr;
    scene::Mapping* mapping = nullptr;  // null: an independent state
    std::size_t above = 0;              // layer that it follows; lies before this one
    int first_node = 0;                 // of the system's, for an independent state
    std::vector<scene::Mass*> masses = {};
    std::vector<scene::ForceField*> force_fields = {};

    bool is_loaded = false;  // of those that follow: something acts on it, or on one that follows it

    // of the matrix of describe: what its kernels do not know
    std::vector<const scene::ForceField*> other_fields = {};
    bool has_others = false;  // of those that follow: something of the matrix is there, or at one that follows it

    // scratch of the states that follow
    PointArray x = {}, v = {}, f = {};
    BlockMatrix blocks = BlockMatrix();
    MatrixFreeSystem part = {};  // scratch of one independent state of several
  };

  static constexpr std::size_t kAtRest = static_cast<std::size_t>(-1);  // in place of a layer

  /// Between two states, of which one may be at rest.
  struct Interaction {
    scene::Interaction* field = nullptr;
    std::array<std::size_t, 2> layers = {};
    bool is_of_roots = true;  // both layers are independent states

    // of the state at rest
    PointArray zero = {}, scratch = {};
  };

  /// On an independent state, or between two states.
  struct Constraint {
    scene::ProjectiveConstraint* of_one = nullptr;
    scene::InteractionProjectiveConstraint* of_two = nullptr;
    std::array<std::size_t, 2> layers = {};  // of_two: the first one may follow; otherwise the same one twice
  };

  /// What of the scene a sum is over: everything, what is neither a body nor a mass, but weight is, what the kernels of
  /// the latest matrix do not know, or what damps explicitly.
  enum class Over { kAll, kLoads, kOthers, kDampers };

  class Others final : public NodalOperator {
   public:
    explicit Others(const NodeSystem& system) : system_(&system) {}
    void add_product(ConstPoints p, Points Fp) const override;
    OperatorFactors factors;

   private:
    const NodeSystem* system_;
  };

  Layer& root(std::size_t i) const { return layers_[i]; }
  std::span<Layer> roots() const { return {layers_.data(), num_roots_}; }
  std::span<Layer> followers() const { return std::span(layers_).subspan(num_roots_); }

  /// The part of a system's field that belongs to a state that another one follows: its own rows, or its scratch.
  template <class Field>
  Field part_of(std::size_t layer, Field of_all, PointArray Layer::*scratch) const {
    if (layer >= num_roots_) return Field(layers_[layer].*scratch);
    return Field(of_all.middleRows(layers_[layer].first_node, layers_[layer].state->num_nodes()));
  }
  template <class Field>
  Field rows_of(const Layer& root, Field of_all) const {
    return Field(of_all.middleRows(root.first_node, root.state->num_nodes()));
  }

  /// The same of both states of an interaction.
  template <class Field>
  Field part_of(const Interaction& interaction, int end, Field of_all, PointArray Layer::*scratch,
                Field at_rest) const {
    return interaction.layers[end] == kAtRest ? at_rest : part_of(interaction.layers[end], of_all, scratch);
  }
  OfTwo<ConstPoints> positions_of(const Interaction& interaction, ConstPoints x) const;
  OfTwo<ConstPoints> velocities_of(const Interaction& interaction, ConstPoints v) const;
  OfTwo<ConstPoints> increments_of(const Interaction& interaction, ConstPoints dx) const;
  OfTwo<Points> forces_of(Interaction& interaction, Points f) const;
  bool is_ours(const scene::MechanicalState* state) const;
  std::size_t layer_of(const scene::MechanicalState* state) const;
  void find_interactions();
  void find_constraints();
  void require_commuting();
  void require_commuting(const Constraint& constraint) const;
  void add_interaction_forces(Over over, bool of_roots, double time, ConstPoints x, ConstPoints v, Points f) const;
  void add_interactions(bool of_roots, const OperatorFactors& factors, ConstPoints dx, Points df) const;
  void project(const Constraint& constraint, Points field) const;

  void gather();
  void scatter() const;
  void add_layers(scene::Node& node);
  void add_force(Over over, double time, ConstPoints x, ConstPoints v, Points f) const;
  void add_force(Over over, const Layer& layer, double time, ConstPoints x, ConstPoints v, Points f) const;
  void add_product(Over over, const OperatorFactors& factors, ConstPoints dx, Points df) const;
  static void add_product(Over over, const Layer& layer, const OperatorFactors& factors, ConstPoints dx, Points df);
  void describe(Layer& root, const OperatorFactors& factors, MatrixFreeSystem& system) const;
  void find_others() const;
  static void add_blocks(const Layer& layer, const OperatorFactors& factors, BlockMatrix& A);

  scene::Node& node_;
  mutable std::vector<Layer> layers_;              // the independent states first; mutable for their scratch
  std::size_t num_roots_ = 0;                      // independent states
  mutable std::vector<Interaction> interactions_;  // likewise
  std::vector<Constraint> constraints_;            // in the order of the scene
  bool constraints_changed_ = false;
  int num_nodes_ = 0;
  mutable Others others_ = Others(*this);
  PointArray x_, v_;       // of several independent states
  PointArray difference_;  // scratch of release and damping_force
};

}  // namespace hexaplast::components
