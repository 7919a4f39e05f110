// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/solve/implicit_euler.hpp"
#include "hexaplast/solve/mechanics.hpp"

namespace hexaplast {

/// A mechanical system over states, of which some follow others by mappings: sums over the masses and forces of each.
/// The states that follow none are one behind the other. What acts on a state that follows is carried up by its
/// mapping. Derived classes fill in what there is.
class LayeredSystem : public MechanicalSystem, private Projector {
 public:
  LayeredSystem(const LayeredSystem&) = delete;

  int num_nodes() const override { return num_nodes_; }
  void set_time_step(double dt) override;
  void compute_force(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const override;
  bool add_operator(const OperatorFactors& factors, MatrixFreeSystem& system) const override;
  void add_load(double time, ConstPoints x, ConstPoints v, Points f) override;
  void add_load_product(const OperatorFactors& factors, ConstPoints dx, Points df) const override;
  bool release(double time, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end, Points force,
               Points product) override;
  void prescribe(double time, Points x, Points v) const override;
  void constrain(Constraints& constraints) const override;

  /// Of all independent states.
  const PointArray& positions();   ///< valid until the next call
  const PointArray& velocities();  ///< likewise

  /// move(x, v) with the positions and velocities of all independent states, which then have what it made of them.
  template <class Move>
  auto advance(const Move& move) {
    if (num_roots_ == 1) return move(layers_[0].state->positions(), layers_[0].state->velocities());
    gather();
    auto result = move(x_, v_);
    scatter();
    return result;
  }

  void project_motion(double time) const;  ///< applies prescribed motion to the states, and lets the others follow
  void follow() const;                     ///< puts the states that follow where the independent ones take them

  double kinetic_energy() const;  ///< [J]

 protected:
  /// gravity [m/s^2] may change.
  explicit LayeredSystem(const Vec3& gravity) : gravity_(gravity) {}

  /// A state and what acts on it.
  struct Layer {
    NodalState* state = nullptr;
    const NodalMapping* mapping = nullptr;  // null: an independent state
    std::size_t above = 0;                  // layer that it follows; lies before this one
    int first_node = 0;                     // of the system's, for an independent state
    std::vector<const NodalMass*> masses = {};
    std::vector<NodalForces*> forces = {};

    bool is_loaded = false;  // of those that follow: something acts on it, or on one that follows it

    // of the matrix of add_operator: what its kernels do not know
    std::vector<const NodalForces*> others = {};
    bool has_others = false;  // of those that follow: something of the matrix is there, or at one that follows it

    // scratch of the states that follow
    PointArray x = {}, v = {}, f = {};
    BlockMatrix blocks = BlockMatrix();
    MatrixFreeSystem part = {};  // scratch of one independent state of several
  };

  static constexpr std::size_t kAtRest = static_cast<std::size_t>(-1);  // in place of a layer

  /// Forces between two states, of which one may be at rest.
  struct Interaction {
    PairForces* forces = nullptr;
    std::array<NodalState*, 2> states = {};
    std::array<std::size_t, 2> layers = {};
    bool is_of_roots = true;      // both layers are independent states
    bool is_in_diagonal = false;  // of the matrix of add_operator, which then knows all of it

    // of the state at rest
    PointArray zero = {}, scratch = {};
  };

  /// On an independent state, or between two states.
  struct Constraint {
    const NodalConstraint* of_one = nullptr;
    const PairConstraint* of_two = nullptr;
    std::array<std::size_t, 2> layers = {};  // of_two: the first one may follow; otherwise the same one twice

    bool couples() const { return of_two && of_two->couples(); }
  };

  /// Independent ones first, then each behind the one that it follows.
  std::size_t add_state(NodalState& state);
  std::size_t add_state(NodalState& state, const NodalMapping& mapping, std::size_t above);
  void add_interaction(PairForces& forces, std::array<NodalState*, 2> states);
  void find_loaded();  ///< when all is there

  std::size_t layer_of(const NodalState* state) const;  ///< kAtRest: it is none of the system's
  std::span<Layer> roots() const { return {layers_.data(), num_roots_}; }
  void project(const Constraint& constraint, Points field) const;  ///< field = what the one constraint leaves of it

  template <class Field>
  Field rows_of(const Layer& root, Field of_all) const {
    return Field(of_all.middleRows(root.first_node, root.state->num_nodes()));
  }

  mutable std::vector<Layer> layers_;              // mutable for their scratch
  std::size_t num_roots_ = 0;                      // independent states
  mutable std::vector<Interaction> interactions_;  // likewise
  std::vector<Constraint> constraints_;            // in the order in which they apply
  int num_nodes_ = 0;

 private:
  /// What a sum is over: everything, what is neither a body nor a mass, but weight is, or what the kernels of the
  /// latest matrix do not know.
  enum class Over { kAll, kLoads, kOthers };

  class Others final : public NodalOperator {
   public:
    explicit Others(const LayeredSystem& system) : system_(&system) {}
    void add_product(double factor, ConstPoints p, Points Fp) const override;
    void add_blocks(double factor, BlockMatrix& A) const override;
    OperatorFactors factors;

   private:
    OperatorFactors times(double factor) const {
      return {factor * factors.mass, factor * factors.damping, factor * factors.stiffness};
    }

    const LayeredSystem* system_;
  };

  /// A field that goes down the mappings.
  struct Down {
    ConstPoints of_all;
    PointArray Layer::*scratch;
  };

  void fix(const Constraint& constraint, NodeMask& free) const;  // where it does not couple
  void project(Points field) const override;                     // what those that couple leave

  std::span<Layer> followers() const { return std::span(layers_).subspan(num_roots_); }

  /// The part of a system's field that belongs to a state that another one follows: its own rows, or its scratch.
  template <class Field>
  Field part_of(const Layer& layer, Field of_all, PointArray Layer::*scratch) const {
    return layer.mapping ? Field(const_cast<Layer&>(layer).*scratch) : rows_of(layer, of_all);
  }

  /// The same of both states of an interaction.
  template <class Field>
  Field part_of(const Interaction& interaction, int end, Field of_all, PointArray Layer::*scratch,
                Field at_rest) const {
    const std::size_t layer = interaction.layers[end];
    return layer == kAtRest ? at_rest : part_of(layers_[layer], of_all, scratch);
  }
  Pair<ConstPoints> positions_of(const Interaction& interaction, ConstPoints x) const;
  Pair<ConstPoints> velocities_of(const Interaction& interaction, ConstPoints v) const;
  Pair<ConstPoints> increments_of(const Interaction& interaction, ConstPoints dx) const;
  Pair<Points> forces_of(Interaction& interaction, Points f) const;

  /// Down the mappings with the fields `down` and up with what add(layer) and add_between(interaction) have added.
  template <class TakesPart, class Add, class AddBetween>
  void sum(const TakesPart& takes_part, std::initializer_list<Down> down, Points up, const Add& add,
           const AddBetween& add_between) const;

  void gather();
  void scatter() const;
  void add_force(Over over, double time, ConstPoints x, ConstPoints v, Points f) const;
  void add_product(Over over, const OperatorFactors& factors, ConstPoints dx, Points df) const;
  static void add_blocks(Over over, const Layer& layer, const OperatorFactors& factors, BlockMatrix& A);
  void add_blocks(Over over, const OperatorFactors& factors, BlockMatrix& A) const;
  void add_operator(Layer& root, const OperatorFactors& factors, MatrixFreeSystem& system) const;
  void find_others() const;

  const Vec3& gravity_;
  mutable Others others_ = Others(*this);
  PointArray x_, v_;       // of several independent states
  PointArray difference_;  // scratch of release
};

}  // namespace hexaplast
