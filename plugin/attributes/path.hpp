// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// The path of what is rigid and moves.
namespace hexaplast::attributes {

inline constexpr Attribute kPathTimes =
    reals("keyTimes", {.unit = "s", .group = "Path"}, "Key times of the path, ascending.");
inline constexpr Attribute kPathPositions =
    vectors3("positions", {.unit = "m", .group = "Path"},
             "Position at each key time, linear in between; constant before the first time and after the last.");
inline constexpr Attribute kPathOrientations =
    reals("orientations", {.group = "Path"},
          "Orientation at each key time, a quaternion x y z w; it turns steadily in between. Default: not turned.");

}  // namespace hexaplast::attributes
