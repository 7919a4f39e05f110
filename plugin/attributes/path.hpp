// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// The path of what is rigid and moves.
namespace hexaplast::attributes {

inline constexpr std::array kPathAttributes = {
    reals("keyTimes", {.unit = "s", .group = "Path"}, "Key times of the path, ascending."),
    vectors3("positions", {.unit = "m", .group = "Path"},
             "Position at each key time, linear in between; constant before the first time and after the last."),
    reals("orientations", {.group = "Path"},
          "Orientation at each key time, a quaternion x y z w; it turns steadily in between. Default: not turned."),
};

/// In SOFA besides: a rigid frame of a scene in place of the path.
inline constexpr std::array kFrameAttributes = {
    link("rigid",
         "In place of a path: a MechanicalObject of rigid frames (template Rigid3d), or its node. One frame prescribes "
         "the motion, on which the body has no effect. Within a step it goes on with the velocity of the frame."),
    integer("rigidIndex", {.initial = "0", .range = kIndex, .group = "Path"}, "Which of the frames."),
};

}  // namespace hexaplast::attributes
