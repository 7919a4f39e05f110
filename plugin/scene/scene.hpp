// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "scene/interfaces.hpp"

namespace hexaplast::scene {

/// A graph of nodes and components, and their life: read, initialised, stepped.
///
/// One step, in SOFA's order:
///   1. refresh of components whose inputs changed, begin_step of all            at t_n
///      contacts after all others, as they follow from bodies
///   2. every OdeSolver solves: forces at (x_n, v_n, t_n), one linear solve, x_{n+1} and v_{n+1}; prescribed motion at
///   t_n
///   3. time becomes t_n + dt
///   4. end_step of all: plastic flow at x_{n+1}
///   5. blades open joints
class Scene {
 public:
  Scene();

  Node& root() { return *root_; }
  Diagnostics& diagnostics() { return *diagnostics_; }

  /// Resolves the links, then init and bwd_init of every component. Throws SceneError with all that is wrong.
  void init();

  /// Adds a component to a scene that is ready, between two steps: its init and bwd_init, and bwd_init of the solvers,
  /// which look again at what there is to move. Its attributes have been given before. Throws SceneError; the scene is
  /// then of no more use.
  Component& add(Node& node, std::unique_ptr<Component> component, std::string name);

  /// Back to the state after init, at time 0. Throws SceneError where a component refuses its first attributes.
  void reset();

  /// One time step. Throws SceneError, InputError and NumericalError: positions, velocities and
  /// time are then those before the step, but what components remember may not be. Every further step is refused, with
  /// InputError, until reset or until a state is read; so it is after a state that could not be read.
  SolveReport step();

  /// Opens joints of a body of the scene, between two steps: ForceField::open. Throws SceneError, naming it, where a
  /// component cannot follow, and InputError for joints that are not there; nothing has changed then.
  void open(ForceField& field, std::span<const int> joints, std::span<const double> crossings = {});

  /// Time and all components (Stateful::serialize): into a checkpoint between two steps, or from one right after init.
  /// Throws InputError when the components of the scene are not those that were written, or keep another state, and
  /// where a step has failed, of which no state is written.
  void serialize(Archive& archive);

  double time() { return root_->clock().time; }
  double dt() { return root_->clock().dt; }

 private:
  void init(Component& component);
  void bwd_init(Node& node);
  void restore(Archive& archive);
  void follow_all_inputs();
  void require_whole() const;
  void keep_motion();
  void restore_motion();
  void bwd_init(Component& component);
  template <class Call>
  void attempt(Component& component, const Call& call);

  // On the heap, so that objects may keep references while the scene is moved.
  std::unique_ptr<Diagnostics> diagnostics_;
  std::unique_ptr<Node> root_;

  struct Motion {
    PointArray positions, velocities;
  };
  std::vector<Motion> motion_before_;  // of each state, before the latest step
  double time_before_ = 0;             // [s]
  const char* trouble_ = nullptr;      // why components may not fit together; null: they do
};

/// The events that an AnimationLoop sends to everything in a node and below.
void begin_step(Node& node);
void end_step(Node& node, double dt);  ///< then the joints open that blades have met

/// Rejects the scene, naming it, where a component that acts on the nodes of a body cannot follow when they split.
void require_followers(ForceField& field);

/// What a body sends to the scene when its nodes are others: FollowsNodes::nodes_changed.
void announce_nodes(ForceField& field, std::span<const int> split_from);

/// What a body sends to the whole scene that it belongs to, when hexahedra have gone: Component::hexahedra_removed.
void announce_removed(const ForceField& field, std::span<const int> hexahedra);

}  // namespace hexaplast::scene
