// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Prescribed motion. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kFixedProjectiveConstraintAttributes[] = {
    {.name = "indices",
     .type = Type::kIntegers,
     .initial = "0",
     .range = kIndex,
     .help = "Nodes that receive no acceleration."},
    {.name = "fixAll", .type = Type::kBool, .initial = "false", .help = "Fixes every node."},
    {.name = "showObject",
     .type = Type::kBool,
     .initial = "true",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
    {.name = "drawSize",
     .type = Type::kReal,
     .initial = "0",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
};
inline constexpr Description kFixedProjectiveConstraint{
    .class_name = "FixedProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help = "Holds nodes: their acceleration is zero, so that a velocity they begin with persists.",
    .templates = kVec3Templates,
    .attributes = kFixedProjectiveConstraintAttributes};

}  // namespace hexaplast::attributes
