// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Parts of a body found by their place. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kBoxROIAttributes[] = {
    {.name = "box",
     .type = Type::kBoxes,
     .initial = "0 0 0 1 1 1",
     .unit = "m",
     .help = "Two opposite corners of each box, in any order. Points on the border are inside."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Points to look at; the rest positions of the node's mechanical state where not given."},
    {.name = "strict",
     .type = Type::kBool,
     .initial = "true",
     .help = "A hexahedron is inside when all its nodes are; otherwise when its centre is."},
    {.name = "drawBoxes",
     .type = Type::kBool,
     .initial = "false",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
    {.name = "indices", .type = Type::kIntegers, .access = Access::kOutput, .help = "Points inside, ascending."},
    {.name = "indicesOut", .type = Type::kIntegers, .access = Access::kOutput, .help = "Points outside, ascending."},
    {.name = "hexahedronIndices",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "Hexahedra inside, ascending."},
    {.name = "pointsInROI",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Their positions."},
};
inline constexpr Description kBoxROI{.class_name = "BoxROI",
                                     .category = "Engine",
                                     .help = "Finds what lies in boxes.",
                                     .templates = kVec3Templates,
                                     .attributes = kBoxROIAttributes};

}  // namespace hexaplast::attributes
