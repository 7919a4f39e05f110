// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/interfaces.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// All forces [N] on the undeformed body at rest that do not come from the body itself: weight and loads.
PointArray loads_at(double time, scene::Scene& scene, scene::MechanicalState& state);

/// Ones, and zeros for the degrees of freedom that constraints hold: num_nodes x 3.
PointArray free_directions(scene::Scene& scene, scene::MechanicalState& state);

}  // namespace hexaplast::runner
