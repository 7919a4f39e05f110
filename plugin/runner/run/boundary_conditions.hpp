// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <set>
#include <vector>

#include "picture/boundary_conditions.hpp"
#include "runner/run/simulation.hpp"
#include "scene/interfaces.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// All forces [N] on the undeformed body at rest that do not come from the body itself: weight and loads.
PointArray loads_at(double time, scene::Scene& scene, scene::MechanicalState& state);

/// Ones, and zeros for the degrees of freedom that constraints hold: num_nodes x 3.
PointArray free_directions(scene::Scene& scene, scene::MechanicalState& state);

/// What holds and loads the state of a simulation: loads at its present positions, as they were at the beginning of the
/// latest step, which is when steps take them; loads on states that follow are carried up to it. Without weight.
output::BoundaryConditions conditions_of(Simulation& simulation);

/// Nodes that are fixed or prescribed in all three directions, ascending.
std::vector<int> fixed_nodes(Simulation& simulation);

/// Nodes of the bodies that carry prescribed forces.
std::set<int> loaded_nodes(Simulation& simulation);

/// Whether elongation and twist between the end sections of the longest axis are measured: as RunSettings.endSections
/// says, or if there is one body that is stretched or twisted by its ends: what fixes, moves or loads nodes acts on
/// both end sections, and otherwise on whole cross sections alone.
bool measures_ends(Simulation& simulation);

}  // namespace hexaplast::runner
