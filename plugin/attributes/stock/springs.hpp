// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Springs between nodes. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kSpringRayleigh{.name = "rayleighStiffness",
                                           .type = Type::kReal,
                                           .initial = "0",
                                           .unit = "s",
                                           .range = kNotNegative,
                                           .help = "Damping by their stiffness, in the system matrix alone."};
inline constexpr Attribute kSpringForceFieldAttributes[] = {
    {.name = "object1",
     .type = Type::kLink,
     .help = "The mechanical state of the first nodes; default: that of the node."},
    {.name = "object2",
     .type = Type::kLink,
     .help = "That of the second nodes; default: that of the node. One time integrator moves both states. They may be "
             "mapped ones; a state that nothing moves holds its ends."},
    {.name = "spring",
     .type = Type::kReals,
     .help = "In place of the lists below, five numbers for each: its two nodes, stiffness [N/m], damping [N s/m], "
             "rest length [m]."},
    {.name = "indices1", .type = Type::kIntegers, .range = kIndex, .help = "First nodes, of object1."},
    {.name = "indices2", .type = Type::kIntegers, .range = kIndex, .help = "Second nodes, of object2, as many."},
    {.name = "stiffness",
     .type = Type::kReals,
     .initial = "100",
     .unit = "N/m",
     .range = kNotNegative,
     .help = "One value, or one per spring."},
    {.name = "damping",
     .type = Type::kReals,
     .initial = "5",
     .unit = "N s/m",
     .range = kNotNegative,
     .help = "One value, or one per spring."},
    {.name = "lengths",
     .type = Type::kReals,
     .initial = "0",
     .unit = "m",
     .range = kNotNegative,
     .help = "At rest: one value, or one per spring."},
    {.name = "elongationOnly",
     .type = Type::kBool,
     .initial = "false",
     .help = "No force of springs that are shorter than at rest."},
    kSpringRayleigh,
    visual_attribute("showArrowSize"),
    visual_attribute("drawMode"),
};
inline constexpr Description kSpringForceField{
    .class_name = "SpringForceField",
    .category = "ForceField",
    .help =
        "Springs between nodes of one state, or of two. As in SOFA damping, along the spring, is not part of the "
        "matrix: it may make motions of light nodes grow, and a warning says so.",
    .templates = kVec3Templates,
    .attributes = kSpringForceFieldAttributes};

inline constexpr Attribute kRestShapeSpringsAttributes[] = {
    {.name = "points", .type = Type::kIntegers, .range = kIndex, .help = "Nodes; default: all."},
    {.name = "stiffness",
     .type = Type::kReals,
     .initial = "100",
     .unit = "N/m",
     .range = kNotNegative,
     .help = "One value, or one per node."},
    {.name = "external_rest_shape",
     .type = Type::kLink,
     .help = "A mechanical state to whose positions at the beginning of the step the nodes are pulled. It feels no "
             "force. Default: the rest positions."},
    {.name = "external_points",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Nodes of that state, as many; default: all."},
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Damping by their stiffness, in the system matrix alone."},
    ignored_attribute("angularStiffness", "Ignored here: nodes do not turn."),
    ignored_attribute("recompute_indices", "Ignored here."),
    visual_attribute("drawSpring"),
    visual_attribute("springColor"),
};
inline constexpr Description kRestShapeSpringsForceField{
    .class_name = "RestShapeSpringsForceField",
    .category = "ForceField",
    .help = "Springs that pull nodes back to their rest positions, or to where nodes of another state are.",
    .templates = kVec3Templates,
    .attributes = kRestShapeSpringsAttributes};

}  // namespace hexaplast::attributes
