// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Forces. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kConstantForceFieldAttributes[] = {
    {.name = "indices", .type = Type::kIntegers, .range = kIndex, .help = "Nodes; all of them where not given."},
    {.name = "forces",
     .type = Type::kVectors3,
     .unit = "N",
     .help = "One for every node, or one per index. Counts before totalForce; one of the two is needed."},
    {.name = "totalForce",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "N",
     .help = "Shared equally by the nodes."},
};
inline constexpr Description kConstantForceField{.class_name = "ConstantForceField",
                                                 .category = "ForceField",
                                                 .help = "Forces that never change.",
                                                 .templates = kVec3Templates,
                                                 .attributes = kConstantForceFieldAttributes};

inline constexpr Attribute kLinearForceFieldAttributes[] = {
    {.name = "points", .type = Type::kIntegers, .range = kIndex, .help = "Nodes; each receives the whole force."},
    {.name = "times", .type = Type::kReals, .unit = "s", .help = "Key times, ascending."},
    {.name = "forces",
     .type = Type::kVectors3,
     .unit = "N",
     .help =
         "Force on each node at each key time: none before the first time, linear in between, the last one from the "
         "last time on. Evaluated at the beginning of a step."},
    {.name = "force",
     .type = Type::kReal,
     .initial = "1",
     .help = "Factor of the forces, except from the last time on."},
};
inline constexpr Description kLinearForceField{.class_name = "LinearForceField",
                                               .category = "ForceField",
                                               .help = "Forces that follow a history.",
                                               .templates = kVec3Templates,
                                               .attributes = kLinearForceFieldAttributes};

}  // namespace hexaplast::attributes
