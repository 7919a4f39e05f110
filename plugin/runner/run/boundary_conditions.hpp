// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <set>

#include "runner/run/simulation.hpp"
#include "scene/interfaces.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// All forces [N] on the undeformed body at rest that do not come from the body itself: weight and loads.
PointArray loads_at(double time, scene::Scene& scene, scene::MechanicalState& state);

/// Nodes of the bodies that carry prescribed forces.
std::set<int> loaded_nodes(Simulation& simulation);

/// Whether elongation and twist between the end sections of the longest axis are measured: as RunSettings.endSections
/// says, or if there is one body that is stretched or twisted by its ends: what fixes, moves or loads nodes acts on
/// both end sections, and otherwise on whole cross sections alone.
bool measures_ends(Simulation& simulation);

}  // namespace hexaplast::runner
