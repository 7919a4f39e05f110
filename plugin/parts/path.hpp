// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

#include "hexaplast/contact/instrument_contact.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {

/// Adds what is wrong with the options key_times, positions and orientations of a path: there must be a key time, a
/// position for each, and a quaternion for each or none.
void check_path(OptionErrors& errors, std::span<const double> key_times, ConstPoints positions,
                std::span<const double> orientations);

/// Where a path has got to: linear between two keys, turning steadily; constant before the first and after the last.
/// orientations: quaternions x y z w, one per key time, or none.
Pose pose_on_path(std::span<const double> key_times, ConstPoints positions, std::span<const double> orientations,
                  double time);

}  // namespace hexaplast::parts
