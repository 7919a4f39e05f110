// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/interfaces.hpp"
#include "scene/scene.hpp"

namespace hexaplast::scene {

/// The parts of a scene that a run works on. Throw SceneError unless there is exactly one.
MechanicalState& only_state(Scene& scene);
OdeSolver& only_solver(Scene& scene);

/// The force field that has a body; null: there is none. Throws SceneError where there are two.
ForceField* find_body(Scene& scene);

/// In their order. Throws SceneError where two have the same name, or one has a name that a table cannot have for a
/// column.
std::vector<Probe*> probes_of(Scene& scene);

/// [kg] of the nodes of a state.
double total_mass(const std::vector<Mass*>& masses, MechanicalState& state);

/// The scene's RunSettings; null: there are none.
Component* find_settings(Scene& scene);

}  // namespace hexaplast::scene
