// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <string>

#include "support/simulation.hpp"

namespace hexaplast::support {

/// The test bar: 3 x 3 x 10 cells of 0.1 m, E = 5000 Pa, nu = 0.45, 1000 kg/m^3, Rayleigh damping 0.1 / 0.1, time step
/// 0.01 s, fixed in the middle, loaded at both ends. The load rises over 50 steps, is held to step 200 and then gone;
/// 500 steps in all.
inline constexpr int kBarSteps = 500;

enum class BarLoad {
  kStretch,  ///< 90 N along the axis on the central face of each end
  kTwist     ///< 20 N on each of the four edges of the central face of each end, turning with it
};

/// Material of a preset; `strength` is "high", "medium" or "low": how much of the deformation stays.
Material bar_material(BarLoad load, const std::string& strength);

/// `fracture_stress` [Pa]: elements go when their yield stress has hardened past it.
MovingBody bar(BarLoad load, const std::string& strength,
               double fracture_stress = std::numeric_limits<double>::infinity());

}  // namespace hexaplast::support
