// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "model_check.hpp"
#include "scene/interfaces.hpp"
#include "solve/layered_system.hpp"

namespace hexaplast::components {

/// The components of a node and below as one mechanical system over the states that follow no other, in the order of
/// the scene.
class NodeSystem final : public LayeredSystem {
 public:
  /// Throws InputError unless there is an independent state, all others follow one, and constraints act on independent
  /// ones.
  explicit NodeSystem(scene::Node& node);

  /// As LayeredSystem::advance, after what constraints_changed asks for.
  template <class Move>
  auto advance(const Move& move) {
    if (constraints_changed_) require_commuting();
    return LayeredSystem::advance(move);
  }

  /// Constraints have changed: whether they go together is checked when it advances next, after all of them have.
  void constraints_changed() { constraints_changed_ = true; }

  /// The rows of a field of the system that belong to an independent state of it.
  ConstPoints rows_of_state(const scene::MechanicalState& state, ConstPoints of_all) const;

  /// The first node of a state in the system; -1: it is no independent state of it.
  int first_node_of(const scene::MechanicalState& state) const;

  /// Rejects the scene, naming what no assembled matrix has: constraints that couple nodes, and forces between states
  /// of which one follows another one. `why`: who asks for a matrix.
  void require_matrix(const std::string& why) const;

  /// Throws InputError, naming the first independent state on which no mass acts, nor on those that follow it.
  void require_mass() const;
  double elastic_energy() const;     ///< [J] of the bodies
  double recovery_work() const;      ///< [J] of the bodies
  double highest_frequency() const;  ///< [rad/s] about that of the bodies' fastest vibration; 0: nothing vibrates

  void warn_of_sizes() const;  ///< remarks of bodies that have a size of no tissue

 private:
  void find_states();
  void find_constraints();
  void require_commuting();
  void require_commuting(const Constraint& constraint) const;

  /// visit(body, layer) for each body.
  template <class Visit>
  void for_each_body(const Visit& visit) const;
  ModelCheck check(const scene::ForceField& body, const Layer& layer) const;

  scene::Node& node_;
  bool constraints_changed_ = false;
};

}  // namespace hexaplast::components
