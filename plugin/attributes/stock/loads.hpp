// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Forces. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kConstantForceFieldAttributes[] = {
    {.name = "indices", .type = Type::kIntegers, .range = kIndex, .help = "Nodes; default: all."},
    {.name = "forces",
     .type = Type::kVectors3,
     .unit = "N",
     .help = "One for all nodes, or one per index. Counts before totalForce; one of the two is needed."},
    {.name = "totalForce",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "N",
     .help = "Divided equally among the nodes."},
    ignored_attribute("topology", "Ignored here: nodes keep their numbers."),
    visual_attribute("showArrowSize"),
    visual_attribute("showColor"),
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
     .help = "Force on each node at each key time: none before the first time, linear in between, constant after the "
             "last. That at the beginning of a step counts."},
    {.name = "force",
     .type = Type::kReal,
     .initial = "1",
     .help = "Factor of the forces, except from the last time on."},
    visual_attribute("arrowSizeCoef"),
};
inline constexpr Description kLinearForceField{.class_name = "LinearForceField",
                                               .category = "ForceField",
                                               .help = "Forces that follow a history.",
                                               .templates = kVec3Templates,
                                               .attributes = kLinearForceFieldAttributes};

inline constexpr Attribute kLoadTopology{
    .name = "topology", .type = Type::kLink, .help = "The faces; default: the nearest topology."};

inline constexpr Attribute kSurfacePressureAttributes[] = {
    {.name = "pressure",
     .type = Type::kReal,
     .initial = "0",
     .unit = "Pa",
     .help = "Along the normal of the order of a face's nodes: positive values pull outwards on hexahedra."},
    {.name = "quadIndices",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Quads of the topology; default: all between min and max."},
    {.name = "triangleIndices",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Triangles of the topology; default: all between min and max."},
    {.name = "min",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "m",
     .help = "Without indices, faces count while all their nodes lie in the box from here to max; if both are 0, "
             "everywhere."},
    {.name = "max", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "The other corner of the box."},
    ignored_attribute("useTangentStiffness",
                      "Ignored here: the loads have no part in the matrix (in SOFA that of "
                      "triangles has, and makes it non-symmetric)."),
    kLoadTopology,
    visual_attribute("drawForceScale"),
};
inline constexpr Description kSurfacePressureForceField{
    .class_name = "SurfacePressureForceField",
    .category = "ForceField",
    .help =
        "Pressure on faces in their current shape; a quad counts as two triangles. Faces of removed hexahedra carry no "
        "load.",
    .templates = kVec3Templates,
    .attributes = kSurfacePressureAttributes};

inline constexpr Attribute kPlaneAttributes[] = {
    {.name = "normal",
     .type = Type::kVector3,
     .initial = "0 1 0",
     .help = "Points away from the obstacle. Taken as it is: give a unit vector."},
    {.name = "d", .type = Type::kReal, .initial = "0", .unit = "m", .help = "The plane is normal.x = d."},
    {.name = "stiffness",
     .type = Type::kReal,
     .initial = "500",
     .unit = "N/m",
     .range = kNotNegative,
     .help = "Force on a node per depth."},
    {.name = "damping",
     .type = Type::kReal,
     .initial = "5",
     .unit = "N s/m^2",
     .range = kNotNegative,
     .help = "Force against the velocity of a node, per velocity and depth."},
    {.name = "maxForce",
     .type = Type::kReal,
     .initial = "0",
     .unit = "N",
     .range = kNotNegative,
     .help = "Largest force on a node; 0: no limit."},
    {.name = "bilateral",
     .type = Type::kBool,
     .initial = "false",
     .help = "Nodes on either side are pushed to the plane."},
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Stiffness-proportional damping in the system matrix alone, besides the solver's own."},
    visual_attribute("showPlane"),
    visual_attribute("planeColor"),
    visual_attribute("showPlaneSize"),
};
inline constexpr Description kPlaneForceField{.class_name = "PlaneForceField",
                                              .category = "ForceField",
                                              .help = "An elastic obstacle behind a plane.",
                                              .templates = kVec3Templates,
                                              .attributes = kPlaneAttributes};

}  // namespace hexaplast::attributes
