// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "scene/interfaces.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// All forces [N] on the undeformed body at rest that do not come from the body itself: weight and loads.
PointArray loads_at(double time, scene::Scene& scene, scene::MechanicalState& state);

/// Time [s] of the first step at which the loads on states are largest, among the first `num_steps`, of which every
/// `stride`-th is looked at.
double time_of_greatest_loads(scene::Scene& scene, std::span<scene::MechanicalState* const> states, long num_steps,
                              long stride = 1);

/// Ones, and zeros for the degrees of freedom that constraints hold: num_nodes x 3.
PointArray free_directions(scene::Scene& scene, scene::MechanicalState& state);

}  // namespace hexaplast::runner
