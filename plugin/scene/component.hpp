// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string_view>

#include "hexaplast/base/archive.hpp"
#include "scene/object.hpp"

namespace hexaplast::scene {

class ForceField;
class Node;

/// A part of a scene. The host calls, in this order:
///
///   init        once, nodes from the top down, components in the order of the scene file
///   bwd_init    once, nodes from the bottom up, when all of init is done
///   then per time step (scene.hpp):
///   refresh     of those that are Changeable: only where an attribute changed that the component reads
///   begin_step  at time t_n
///   ...         what its category does (interfaces.hpp)
///   end_step    at time t_n + dt, positions accepted: the only call in which a component may change plastic history
///   hexahedra_removed
///               from within the end_step of a body that has lost hexahedra, or between two steps
///   nodes_changed
///               of those that follow nodes (FollowsNodes), where joints of a body open after the end of a step, and
///               from within the reset and the serialize of such a body
/// and at any time between steps reset and serialize, of those that are Stateful.
///
/// Any of them may refuse the scene with reject() or InputError, and give up with NumericalError.
class Component : public Object {
 public:
  using Object::Object;

  virtual void init() {}
  virtual void bwd_init() {}
  virtual void begin_step() {}
  virtual void end_step(double /*dt*/) {}

  /// A body of the scene has lost hexahedra, in the step that ends or by ForceField::remove_elements: `field.body()` is
  /// without them already, its history lists them among all that have gone, and field.node() tells where it stands.
  /// `hexahedra` are their numbers in the body's mesh and its topology, each once in a run, valid during the call. All
  /// components of the scene are called, in their order; those that stand after the body have their own end_step still
  /// to come. After reset all hexahedra are there again; nothing is said of that.
  virtual void hexahedra_removed(const ForceField& /*field*/, std::span<const int> /*hexahedra*/) {}

  Node& node() const { return *node_; }

  /// For the host: calls refresh if an input changed since init or since the last call. A component that is not
  /// Changeable rejects the scene then: nothing may follow a changing source unnoticed.
  void follow_inputs();

  /// Whether it looks at its inputs when it is asked for something, and is told of no change: inputs that are costly to
  /// compute are then not computed every step.
  virtual bool looks_by_itself() const { return false; }

  /// How far the host has come with this component.
  enum class Stage { kMade, kReady, kFailed };
  Stage stage() const { return stage_; }

 protected:
  /// The three below are defined in node.hpp.
  ///
  /// The component that a link attribute leads to, or, where it is not given, the nearest one of category T in this
  /// node or above. Rejects the scene where there is none.
  template <class T>
  T& linked(std::string_view attribute);

  /// The nearest one of category T in this node or above; rejects the scene where there is none.
  template <class T>
  T& needed();

  /// The same, and its init is done.
  template <class T>
  T& needed_ready();

 private:
  friend class Node;
  friend class Scene;

  [[noreturn]] void reject_missing(std::string_view category);
  [[noreturn]] void reject_late(std::string_view category, const Component& other);
  void require_sound(const Component& other) const;
  Node* node_ = nullptr;
  Stage stage_ = Stage::kMade;
};

/// A component whose attributes may change during a run. Others refuse every change.
class Changeable {
 public:
  virtual ~Changeable() = default;

  /// Reads the attributes that have changed, at least one, since init or since this was called last. What the component
  /// remembers stays. Rejects the scene where a change cannot be.
  virtual void refresh(std::span<const std::string_view> changed) = 0;

  /// Whether an input that is no link to a component may change: where not, a scene that changes it is refused before
  /// it runs.
  virtual bool may_change(std::string_view /*attribute*/) const { return true; }
};

/// A component that remembers something from one step to the next.
class Stateful {
 public:
  virtual ~Stateful() = default;

  /// Back to the state after init.
  virtual void reset() = 0;

  /// Lists what the next step depends on and neither the attributes nor init give, once for both directions: it is
  /// written into a checkpoint between two steps, and read from one after init, by a scene that is to go on bit for bit
  /// (Archive). What came from refresh is there again. Throws InputError for values that cannot be.
  virtual void serialize(Archive& archive) = 0;
};

/// Thrown when a component needs another one that has failed already: nothing new to report.
struct DependencyFailure {};

}  // namespace hexaplast::scene
