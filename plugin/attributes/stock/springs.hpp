// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Springs between nodes. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kSpringRayleigh =
    real("rayleighStiffness", {.initial = "0", .unit = "s", .range = kNotNegative},
         "Damping by their stiffness, in the system matrix alone.");
inline constexpr std::array kSpringForceFieldAttributes = {
    link("object1", "The mechanical state of the first nodes; default: that of the node."),
    link("object2",
         "That of the second nodes; default: that of the node. One time integrator moves both states. They may be "
         "mapped ones; a state that nothing moves holds its ends."),
    reals("spring",
          "In place of the lists below, five numbers for each: its two nodes, stiffness [N/m], damping [N s/m], rest "
          "length [m]."),
    indices("indices1", "First nodes, of object1."),
    indices("indices2", "Second nodes, of object2, as many."),
    reals("stiffness", {.initial = "100", .unit = "N/m", .range = kNotNegative}, "One value, or one per spring."),
    reals("damping", {.initial = "5", .unit = "N s/m", .range = kNotNegative}, "One value, or one per spring."),
    reals("lengths", {.initial = "0", .unit = "m", .range = kNotNegative}, "At rest: one value, or one per spring."),
    boolean("elongationOnly", {.initial = "false"}, "No force of springs that are shorter than at rest."),
    kSpringRayleigh,
    visual_attribute("showArrowSize"),
    visual_attribute("drawMode"),
};
inline constexpr Description kSpringForceField =
    force_field("SpringForceField",
                "Springs between nodes of one state, or of two. As in SOFA damping, along the spring, is not part of "
                "the matrix: it may make motions of light nodes grow, and a warning says so.",
                kSpringForceFieldAttributes);

inline constexpr std::array kRestShapeSpringsAttributes = {
    indices("points", "Nodes; default: all."),
    reals("stiffness", {.initial = "100", .unit = "N/m", .range = kNotNegative}, "One value, or one per node."),
    link("external_rest_shape",
         "A mechanical state to whose positions at the beginning of the step the nodes are pulled. It feels no force. "
         "Default: the rest positions."),
    indices("external_points", "Nodes of that state, as many; default: all."),
    kSpringRayleigh,
    ignored_attribute("angularStiffness", "Ignored here: nodes do not turn."),
    ignored_attribute("recompute_indices", "Ignored here."),
    visual_attribute("drawSpring"),
    visual_attribute("springColor"),
};
inline constexpr Description kRestShapeSpringsForceField =
    force_field("RestShapeSpringsForceField",
                "Springs that pull nodes back to their rest positions, or to where nodes of another state are.",
                kRestShapeSpringsAttributes);

}  // namespace hexaplast::attributes
