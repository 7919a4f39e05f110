// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Forces. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr std::array kConstantForceFieldAttributes = {
    indices("indices", "Nodes; default: all."),
    vectors3("forces", {.unit = "N"},
             "One for all nodes, or one per index. Counts before totalForce; one of the two is needed."),
    vector3("totalForce", {.initial = "0 0 0", .unit = "N"}, "Divided equally among the nodes."),
    ignored_attribute("topology", "Ignored here: nodes keep their numbers."),
    visual_attribute("showArrowSize"),
    visual_attribute("showColor"),
};
inline constexpr Description kConstantForceField =
    force_field("ConstantForceField", "Forces that never change.", kConstantForceFieldAttributes);

inline constexpr std::array kLinearForceFieldAttributes = {
    indices("points", "Nodes; each receives the whole force."),
    reals("times", {.unit = "s"}, "Key times, ascending."),
    vectors3("forces", {.unit = "N"},
             "Force on each node at each key time: none before the first time, linear in between, constant after the "
             "last. That at the beginning of a step counts."),
    real("force", {.initial = "1"}, "Factor of the forces, except from the last time on."),
    visual_attribute("arrowSizeCoef"),
};
inline constexpr Description kLinearForceField =
    force_field("LinearForceField", "Forces that follow a history.", kLinearForceFieldAttributes);

inline constexpr Attribute kLoadTopology = link("topology", "The faces; default: the nearest topology.");

inline constexpr std::array kSurfacePressureAttributes = {
    real("pressure", {.initial = "0", .unit = "Pa"},
         "Along the normal of the order of a face's nodes: positive values pull outwards on hexahedra."),
    indices("quadIndices", "Quads of the topology; default: all between min and max."),
    indices("triangleIndices", "Triangles of the topology; default: all between min and max."),
    vector3("min", {.initial = "0 0 0", .unit = "m"},
            "Without indices, faces count while all their nodes lie in the box from here to max; if both are 0, "
            "everywhere."),
    vector3("max", {.initial = "0 0 0", .unit = "m"}, "The other corner of the box."),
    ignored_attribute("useTangentStiffness",
                      "Ignored here: the loads have no part in the matrix (in SOFA that of "
                      "triangles has, and makes it non-symmetric)."),
    kLoadTopology,
    visual_attribute("drawForceScale"),
};
inline constexpr Description kSurfacePressureForceField =
    force_field("SurfacePressureForceField",
                "Pressure on faces in their current shape; a quad counts as two triangles. Faces of removed hexahedra "
                "carry no load.",
                kSurfacePressureAttributes);

inline constexpr auto kPlaneAttributes = joined(
    std::array{
        vector3("normal", {.initial = "0 1 0"}, "Points away from the obstacle. Taken as it is: give a unit vector."),
        real("d", {.initial = "0", .unit = "m"}, "The plane is normal.x = d."),
        real("stiffness", {.initial = "500", .unit = "N/m", .range = kNotNegative}, "Force on a node per depth."),
        real("damping", {.initial = "5", .unit = "N s/m^2", .range = kNotNegative},
             "Force against the velocity of a node, per velocity and depth."),
        real("maxForce", {.initial = "0", .unit = "N", .range = kNotNegative}, "Largest force on a node; 0: no limit."),
        boolean("bilateral", {.initial = "false"}, "Nodes on either side are pushed to the plane."),
        kForceRayleigh,
    },
    visual_attributes("showPlane", "planeColor", "showPlaneSize"));
inline constexpr Description kPlaneForceField =
    force_field("PlaneForceField", "An elastic obstacle behind a plane.", kPlaneAttributes);

}  // namespace hexaplast::attributes
