// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/solve/energy_balance.hpp"
#include "hexaplast/solve/mechanics.hpp"
#include "scene/node.hpp"

namespace hexaplast {
class Body;
class NodeCopies;
struct FlowReport;
}  // namespace hexaplast

/// The categories of components: what each promises to the others. Nodal fields are num_nodes x 3.
namespace hexaplast::scene {

class Topology : public Component {
 public:
  static constexpr std::string_view kCategory = "Topology";
  using Component::Component;

  /// Available from the moment the scene is read, whatever the order of components. May reject the scene.
  virtual const PointArray& positions() = 0;  ///< [m]; empty where only the cells are known
  virtual const std::vector<Hexahedron>& hexahedra() = 0;

  /// Cells of lower dimension, where a topology has them.
  virtual const std::vector<Quad>& quads();
  virtual const std::vector<Triangle>& triangles();
  virtual const std::vector<Edge>& edges();

  /// Factor of the stiffness of each hexahedron > 0: its fraction of matter; empty: all are full.
  virtual std::span<const double> fill() { return {}; }
};

class ForceField;

/// What time integrators move and mappings carry.
class MechanicalState : public Component, public NodalState {
 public:
  static constexpr std::string_view kCategory = "MechanicalState";
  using Component::Component;

  virtual const PointArray& rest_positions() const = 0;  ///< [m]

  /// The body that its nodes split with, where joints of it have been opened once (ForceField::open); null: none has.
  const Body* split_by() const { return split_by_; }
  /// What its nodes have become; null where none ever split. What a scene gives for nodes is for the initial ones.
  const NodeCopies* copies() const;
  int num_initial_nodes();

 private:
  friend void announce_nodes(ForceField& field, std::span<const int> split_from);
  const Body* split_by_ = nullptr;
};

/// A component that acts on nodes, and goes on where they split: some of a state become several at one place, and are
/// one again after reset. A body with other components on its state is not opened.
class FollowsNodes {
 public:
  virtual ~FollowsNodes() = default;

  /// The nodes of a state, any one of the scene, are others than before: see state.copies(). split_from: of the last
  /// ones, which have come since, the one that each was split from; empty after reset, and where a state is read. The
  /// body has its new nodes; states come first, integrators last. Must not fail.
  virtual void nodes_changed(MechanicalState& state, std::span<const int> split_from) = 0;

  /// Why the nodes of a state cannot split with a body; empty: they can. Asked before anything changes.
  virtual std::string cannot_follow(const MechanicalState& /*state*/, const Body& /*body*/) const { return {}; }
};

/// Of the nearest mechanical state.
class Mass : public Component, public NodalMass {
 public:
  static constexpr std::string_view kCategory = "Mass";
  using Component::Component;
};

/// Forces on the nearest mechanical state.
class ForceField : public Component, public NodalForces {
 public:
  static constexpr std::string_view kCategory = "ForceField";
  using Component::Component;

  /// Nodes that carry forces prescribed by the scene; empty for the others.
  virtual std::span<const int> loaded_nodes() const { return {}; }

  /// The body that makes the forces, and what its latest plastic step did; null: none.
  virtual const Body* body() const { return nullptr; }
  virtual const FlowReport* flow_report() const { return nullptr; }
  bool is_body() const final { return body() != nullptr; }

  /// Takes hexahedra out of the body, between two steps.
  virtual void remove_elements(std::span<const int> /*elements*/) {}

  /// Opens joints of the body (Body::open), between two steps, or at the end of one, when all of end_step is done. What
  /// acts on its nodes follows (FollowsNodes). Rejects the scene, and nothing has changed, where something cannot;
  /// throws InputError for joints that are not there.
  virtual void open(std::span<const int> /*joints*/, std::span<const double> /*crossings*/) {}
};

/// Forces between two mechanical states, or within one. A state may follow another one; one of the two may be at rest,
/// where no integrator moves it. Otherwise one integrator moves both.
class Interaction : public PairForces {
 public:
  /// The same one twice for forces within a state. Known from init on; null, both of them: a ForceField that might be
  /// between states acts on its nearest one.
  virtual std::array<MechanicalState*, 2> states() const = 0;
};

/// What is between states and nothing else.
class InteractionForceField : public Component, public Interaction {
 public:
  static constexpr std::string_view kCategory = "InteractionForceField";
  using Component::Component;
};

class ProjectiveConstraint : public Component, public NodalConstraint {
 public:
  static constexpr std::string_view kCategory = "ProjectiveConstraint";
  using Component::Component;
};

class InteractionProjectiveConstraint : public Component, public PairConstraint {
 public:
  static constexpr std::string_view kCategory = "InteractionProjectiveConstraint";
  using Component::Component;

  virtual std::array<MechanicalState*, 2> states() const = 0;  ///< known from init on
};

class SurvivingCells;

/// Makes the state of its node follow another one.
class Mapping : public Component, public NodalMapping {
 public:
  static constexpr std::string_view kCategory = "Mapping";
  using Component::Component;

  /// Null, both of them, where what follows is drawing: there is nothing to do then. Known from bwd_init on.
  virtual MechanicalState* input() const = 0;
  virtual MechanicalState* output() const = 0;

  /// Whether each node of the state that follows is one of the other state, and splits with it.
  virtual bool is_node_by_node() const { return false; }

  /// Whether a cell of the state that follows is left: `above` tells of nodes of the followed state.
  virtual bool is_left(std::span<const int> cell, const SurvivingCells& above) const = 0;
};

/// What is left of a mechanical state's cells where bodies have lost hexahedra: cells of the bodies' nodes, and cells
/// of points that follow them. Looks at the bodies as they are at the moment; to be made when it is needed.
class SurvivingCells {
 public:
  explicit SurvivingCells(MechanicalState& state);

  /// cell: nodes of the state, at least one. False when all hexahedra are gone that had the whole cell, on their nodes
  /// or, through mappings, within them.
  bool has(std::span<const int> cell) const;

 private:
  std::vector<const Body*> bodies_;              // on the state
  const Mapping* mapping_ = nullptr;             // that the state follows; null: none
  std::unique_ptr<const SurvivingCells> above_;  // of the followed state
};

/// Cells of initial nodes as they are now where nodes of a state have split: with the corners of the lowest hexahedron
/// that is left and has the whole cell; of a cell that none has, each node keeps its number.
class PresentCells {
 public:
  explicit PresentCells(const MechanicalState& state) : body_(state.split_by()) {}

  template <std::size_t N>
  std::array<int, N> operator()(std::array<int, N> cell) const {
    follow(cell);
    return cell;
  }

 private:
  void follow(std::span<int> cell) const;

  const Body* body_;  // null: no node has split
};

/// The states below a node that follow no other one.
std::vector<MechanicalState*> independent_states(const Node& node);

/// Whether a force field, mass or constraint belongs to a state: the nearest one to it. What is between states belongs
/// to none.
bool acts_on(const Component& component, const MechanicalState& state);

/// The masses of a state in a node and below.
std::vector<Mass*> masses_of(const Node& node, const MechanicalState& state);

/// Serves the linear systems of an OdeSolver.
class LinearSolver : public Component {
 public:
  static constexpr std::string_view kCategory = "LinearSolver";
  using Component::Component;

  virtual hexaplast::LinearSolver& method() = 0;

  /// Whether it needs an assembled matrix (LinearSystem::assemble).
  virtual bool needs_matrix() { return false; }

  /// Told of what method() did in each step.
  virtual void heed(const SolveReport& /*report*/) {}
};

/// Advances the mechanical state of its node, or of a node below, by one time step.
class OdeSolver : public Component {
 public:
  static constexpr std::string_view kCategory = "OdeSolver";
  using Component::Component;

  virtual SolveReport solve(double time, double dt) = 0;
  virtual double kinetic_energy() const = 0;  ///< [J] of what it advances

  /// Keeps the balance of energy from now on, between two steps. It changes nothing in the motion.
  virtual void keep_energy_balance() {}

  /// All steps so far, the plastic ones included, since the beginning; null where none is kept, or the solver keeps
  /// none. Between two steps; valid until the next call.
  virtual const EnergyBalance* energy_balance() { return nullptr; }

  /// Told by a body before its elastic energy changes otherwise than by motion and plastic steps.
  virtual void body_changes() {}

  /// Solves a step from where everything is, under the loads of that time, and moves nothing. Rejects the scene where
  /// that fails.
  virtual SolveReport try_step(double /*time*/, double /*dt*/) { return {}; }
};

/// Computes outputs from inputs: each when it is asked for and an input has changed since it was found.
class Engine : public Component {
 public:
  static constexpr std::string_view kCategory = "Engine";
  using Component::Component;

  bool looks_by_itself() const final { return true; }
  void provide(Data& output) final;

 protected:
  /// Finds the output of that name, and of the others what comes with it.
  virtual void compute(std::string_view output) = 0;

  /// For compute(): an output that is found.
  void found(std::string_view output, Value value);

 private:
  bool is_computing_ = false;
  std::set<const Data*> computed_;  // outputs that were found from the inputs as they are
};

/// Lists of numbers at one moment: each output is computed once, however many follow it.
class Readings {
 public:
  /// What Object::reals gives.
  const std::vector<double>& reals(Object& reader, std::string_view name) {
    const Data* source = reader.find_data(name);
    while (source->source()) source = source->source();
    return known_.insert(source).second ? reader.reals(name) : std::get<std::vector<double>>(source->latest());
  }

 private:
  std::set<const Data*> known_;
};

/// A number that is recorded after every step, under the name of the component.
class Probe : public Component {
 public:
  static constexpr std::string_view kCategory = "Probe";
  using Component::Component;

  virtual double read(Readings& readings) = 0;  ///< at accepted positions; from init on
  virtual std::string_view unit() = 0;          ///< empty: none
};

/// The order of events of a time step.
class AnimationLoop : public Component {
 public:
  static constexpr std::string_view kCategory = "AnimationLoop";
  using Component::Component;

  /// One step of everything in its node and below. Reports the sum of iterations and the worst residual of all solves.
  virtual SolveReport step() = 0;
};

/// Opens joints of a body at the end of each step. All blades of a body act together: none sees what another one opens.
class Blade : public Component {
 public:
  static constexpr std::string_view kCategory = "Controller";
  using Component::Component;

  virtual ForceField& field() = 0;  ///< of the body; known from bwd_init on

  /// The joints that it opens (ForceField::open), asked when end_step of all is done. Valid until the next step.
  virtual std::span<const int> joints() = 0;
  virtual std::span<const double> crossings() const = 0;  ///< of these
};

/// What a force field is besides, whose forces load the body from outside: prescribed forces, pushes of obstacles,
/// pulls of instruments. Files and pictures of a run show them.
class Load {
 public:
  virtual ~Load() = default;

  /// f += those forces [N] at (x, v, time), num_nodes x 3 [m, m/s, s]. Changes nothing but f, so that it may be called
  /// between two steps.
  virtual void add_load(double time, ConstPoints x, ConstPoints v, Points f) const = 0;
};

/// What a force field is besides, whose forces have a potential at each moment.
class Potential {
 public:
  virtual ~Potential() = default;

  /// [J] at positions x (num_nodes x 3) and a time: the forces are minus its gradient with respect to x.
  virtual double potential_energy(double time, ConstPoints x) const = 0;
};

/// What a time integrator is besides, that can tell the forces of constraints.
class Supports {
 public:
  virtual ~Supports() = default;

  /// Keeps them from now on. It changes nothing in the motion, and costs a step about two products.
  virtual void keep_support_forces() = 0;

  /// [N] on each node of an independent state that it moves, in the latest step: by which constraints held nodes or
  /// prescribed them; zero on free degrees of freedom. No rows before the first step.
  virtual PointArray support_forces(const MechanicalState& state) = 0;
};

/// What a component is besides, that has outputs which its description cannot know: arrays of a file, by their names.
class ArraySource {
 public:
  virtual ~ArraySource() = default;

  /// The output of that name; null: there is none. Asked for while links are connected, and only for names that are no
  /// attribute of the component.
  virtual Data* array(std::string_view name) = 0;
};

}  // namespace hexaplast::scene
