// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/interfaces.hpp"
#include "scene/scene.hpp"

namespace hexaplast::scene {

/// The states that follow no other one, and the time integrators. Throw SceneError where there is none.
std::vector<MechanicalState*> moving_states(Scene& scene);
std::vector<OdeSolver*> integrators_of(Scene& scene);

/// A force field that has a body, and the state that it deforms.
struct SceneBody {
  std::string name;  ///< that of its node, if that is of letters, digits, _, - and . and no other's; "body_2" else
  ForceField* field = nullptr;
  MechanicalState* state = nullptr;
};

/// In the order of the scene.
std::vector<SceneBody> bodies_of(Scene& scene);

/// What the bodies report of their flow in the latest step: counts are sums, and the averaging is the worst of them.
FlowReport flow_of(const std::vector<SceneBody>& bodies);

/// Of states, those of one behind those of another: those of a single state themselves, else `of_all`.
const PointArray& positions_of(const std::vector<MechanicalState*>& states, PointArray& of_all);
const PointArray& velocities_of(const std::vector<MechanicalState*>& states, PointArray& of_all);

/// The states of bodies; where there is none, those of moving_states.
std::vector<MechanicalState*> shown_states(Scene& scene);

/// The force field that has the only body; null: there is none. Throws SceneError where there are two.
ForceField* find_body(Scene& scene);

/// In their order. Throws SceneError where two have the same name, or one has a name that a table cannot have for a
/// column.
std::vector<Probe*> probes_of(Scene& scene);

/// [kg] of the nodes of a state.
double total_mass(const std::vector<Mass*>& masses, MechanicalState& state);

/// The scene's RunSettings; null: there are none.
Component* find_settings(Scene& scene);

}  // namespace hexaplast::scene
