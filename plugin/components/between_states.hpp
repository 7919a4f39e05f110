// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <optional>
#include <span>

#include "scene/interfaces.hpp"

/// What components between two mechanical states, linked by object1 and object2, have in common, and those that act on
/// bodies.
namespace hexaplast::components {

/// Rejects the scene unless one time integrator, in the component's node or above, moves both states; or one of them,
/// where nothing moves the other one. The integrator.
scene::OdeSolver& require_one_integrator(scene::Component& component, std::array<scene::MechanicalState*, 2> states);

/// The force field on a state that has a body; null: there is none. Throws DependencyFailure where it may be one that
/// has failed.
scene::ForceField* body_field_on(scene::MechanicalState& state);

/// What contact is between, on one state or two.
struct Touching {
  std::array<const Body*, 2> bodies = {};  // of one state: the same twice
  scene::OdeSolver* integrator = nullptr;
};

/// Rejects the scene unless there is a body on each state, and one integrator that suits contact moves them. To be
/// asked when all components have had their init.
Touching find_touching(scene::Component& component, std::span<scene::MechanicalState* const> states);

/// Where nodes of a state are, for what is seen of springs. Valid until the next step.
class SpringEnds {
 public:
  explicit SpringEnds(scene::MechanicalState& state) : state_(state), surviving_(state) {}

  /// [m] None for a node that has lost all its hexahedra.
  std::optional<Vec3> at(int node) const;

 private:
  scene::MechanicalState& state_;
  scene::SurvivingCells surviving_;
};

}  // namespace hexaplast::components
