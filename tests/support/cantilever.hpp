// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/material/material.hpp"

namespace hexaplast::support {

/// Tip deflection of a clamped 1 x 0.1 x 0.1 m beam of cubes, `thickness` of them across, under a small force even over
/// its end, relative to Timoshenko's beam.
double relative_deflection(int thickness, double poisson_ratio, GradientScheme gradient = GradientScheme::kBlended);

}  // namespace hexaplast::support
