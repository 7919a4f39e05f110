// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Contact, the same in every host.
namespace hexaplast::attributes {

inline constexpr Attribute kTangentialStiffness{.name = "tangentialStiffness",
                                                .type = Type::kReal,
                                                .unit = "Pa/m",
                                                .range = kNotNegative,
                                                .help =
                                                    "Shear stress per displacement of tissue that sticks. Default: "
                                                    "contactStiffness. At most 200 times the default of "
                                                    "contactStiffness."};
inline constexpr Attribute kFriction{
    .name = "friction",
    .type = Type::kReal,
    .initial = "0",
    .range = kNotNegative,
    .help = "Coefficient of friction: tissue slips where the tangential force exceeds this times the normal force."};
inline constexpr Attribute kContactDistance{.name = "contactDistance",
                                            .type = Type::kReal,
                                            .initial = "0",
                                            .unit = "m",
                                            .range = kNotNegative,
                                            .help =
                                                "Contact begins at this distance from the surface; at most half of the "
                                                "mean edge."};
inline constexpr Attribute kContactDamping{.name = "damping",
                                           .type = Type::kReal,
                                           .initial = "0",
                                           .unit = "Pa s/m",
                                           .range = kNotNegative,
                                           .help = "Pressure per speed of approach."};

inline constexpr Attribute kActive{
    .name = "active",
    .type = Type::kBool,
    .initial = "true",
    .help = "Whether these two touch. If not, they pass through each other as if this component were not there."};

inline constexpr Attribute kInstrumentContactAttributes[] = {
    {.name = "shape",
     .type = Type::kWord,
     .initial = "sphere",
     .words = "sphere capsule cylinder box surface",
     .help =
         "Shape of the instrument, around the origin of its frame. Capsules and cylinders lie along z. surface: the "
         "inside of the closed surface of surfacePositions and surfaceTriangles."},
    {.name = "radius", .type = Type::kReal, .unit = "m", .range = kPositive, .help = "Of sphere, capsule, cylinder."},
    {.name = "length",
     .type = Type::kReal,
     .unit = "m",
     .range = kPositive,
     .help = "Of cylinder and capsule; of a capsule without its two caps."},
    {.name = "size", .type = Type::kVector3, .unit = "m", .range = kPositive, .help = "Edges of the box."},
    {.name = "surfacePositions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Nodes of the surface in the frame of the instrument, for example @loader.position."},
    {.name = "surfaceTriangles",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Groups of three nodes, counter-clockwise seen from outside, for example @loader.triangles. The surface "
             "must be closed."},
    {.name = "embeddedPositions",
     .type = Type::kVectors3,
     .unit = "m",
     .aliases = "skinPositions",
     .help = "Nodes of a surface that is embedded in the body, in the initial shape, for example @visual.position."},
    {.name = "embeddedTriangles",
     .type = Type::kIntegers,
     .range = kIndex,
     .aliases = "skinTriangles",
     .help = "Groups of three of these nodes. If given, this surface is touched in place of the faces of the "
             "hexahedra."},
    {.name = "keyTimes", .type = Type::kReals, .unit = "s", .help = "Key times of the path, ascending."},
    {.name = "positions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Position of the instrument at each key time, linear in between; it stays at the first position before "
             "the first time and at the last one after the last."},
    {.name = "orientations",
     .type = Type::kReals,
     .help = "Orientation at each key time: quaternions x y z w. In between it turns steadily. Default: not turned."},
    {.name = "contactStiffness",
     .type = Type::kReal,
     .unit = "Pa/m",
     .range = kPositive,
     .help = "Pressure per depth of penetration. Default: 30 E / edge length of the body's hexahedra (the greatest "
             "Young's modulus, the mean edge): a pressure of .3 E is held at a hundredth of an edge. It follows a "
             "modulus that changes, in the same step. At most 200 times the default; from 30 times on a "
             "MultigridCGLinearSolver needs a tolerance of 1e-8."},
    kTangentialStiffness,
    kFriction,
    kContactDistance,
    kContactDamping,
    {.name = "maxSubdivision",
     .type = Type::kInteger,
     .initial = "8",
     .range = {.min = 1, .max = 64},
     .help = "Contact is found at points of the surface: at its nodes, and between them at distances of half the "
             "instrument's smallest radius, but at not more than this number of parts of an edge. A warning appears if "
             "they do not suffice."},
    kActive,
    {.name = "force",
     .type = Type::kVector3,
     .unit = "N",
     .access = Access::kOutput,
     .help = "Force of the body on the instrument at the end of the last step."},
    {.name = "torque",
     .type = Type::kVector3,
     .unit = "N m",
     .access = Access::kOutput,
     .help = "Torque of the body on the instrument about the origin of its frame."},
    {.name = "depth",
     .type = Type::kReals,
     .unit = "m",
     .access = Access::kOutput,
     .help = "How deep the surface is inside the instrument, at most."},
    {.name = "touching", .type = Type::kReals, .access = Access::kOutput, .help = "Number of points that touch."},
    {.name = "slipping", .type = Type::kReals, .access = Access::kOutput, .help = "How many of these slip."},
};
inline constexpr Description kInstrumentContactForceField{
    .class_name = "InstrumentContactForceField",
    .category = "ForceField",
    .help =
        "A rigid instrument that moves along a path and touches the body of the nearest state: it presses, strokes, "
        "drags by friction, and never pulls. Needs an EulerImplicitSolver.",
    .templates = kVec3Templates,
    .attributes = kInstrumentContactAttributes};

/// What it has in SOFA besides: a rigid frame of a scene in place of its path.
inline constexpr Attribute kInstrumentFrameAttributes[] = {
    {.name = "rigid",
     .type = Type::kLink,
     .help =
         "In place of a path: a MechanicalObject of rigid frames (template Rigid3d), or its node, one of which is the "
         "frame of the instrument. It prescribes the motion of the instrument, and the body does not push it. Within a "
         "step the "
         "instrument moves on with the velocity of the frame."},
    {.name = "rigidIndex", .type = Type::kInteger, .initial = "0", .range = kIndex, .help = "Which of the frames."},
};
inline constexpr auto kInstrumentContactInSofaAttributes =
    joined(kInstrumentContactAttributes, kInstrumentFrameAttributes);
inline constexpr Description kInstrumentContactInSofa{.class_name = kInstrumentContactForceField.class_name,
                                                      .category = kInstrumentContactForceField.category,
                                                      .help = kInstrumentContactForceField.help,
                                                      .templates = kInstrumentContactForceField.templates,
                                                      .attributes = kInstrumentContactInSofaAttributes};

inline constexpr Attribute kTissueContactAttributes[] = {
    {.name = "object1", .type = Type::kLink, .help = "The mechanical state of a body; default: that of the node."},
    {.name = "object2",
     .type = Type::kLink,
     .help = "That of the other body. The same one, which is the default: the body touches itself, except within two "
             "hexahedra."},
    {.name = "contactStiffness",
     .type = Type::kReal,
     .unit = "Pa/m",
     .range = kPositive,
     .help = "Pressure per depth of penetration. Default: 30 E / edge length (the greatest Young's modulus, the mean "
             "edge) of that body for which it is less. It follows a modulus that changes, in the same step. At most "
             "200 times the default; from 30 times on a MultigridCGLinearSolver needs a tolerance of 1e-8."},
    kTangentialStiffness,
    kFriction,
    kContactDistance,
    kContactDamping,
    {.name = "maxSubdivision",
     .type = Type::kInteger,
     .initial = "8",
     .range = {.min = 1, .max = 64},
     .help = "Contact is found at points of each surface: at its nodes, and between them at distances of half the mean "
             "edge of the other surface, but at not more than this number of parts of an edge."},
    kActive,
    {.name = "force",
     .type = Type::kVector3,
     .unit = "N",
     .access = Access::kOutput,
     .help = "Force on the body of object1 at the end of the last step. Of a body on itself: zero."},
    {.name = "depth",
     .type = Type::kReals,
     .unit = "m",
     .access = Access::kOutput,
     .help = "How deep a surface is inside the other, at most."},
    {.name = "touching", .type = Type::kReals, .access = Access::kOutput, .help = "Number of points that touch."},
    {.name = "slipping", .type = Type::kReals, .access = Access::kOutput, .help = "How many of these slip."},
};
inline constexpr Description kTissueContactForceField{
    .class_name = "TissueContactForceField",
    .category = "InteractionForceField",
    .help =
        "Two bodies that touch each other, or one that touches itself: they press and drag by friction, and never "
        "pull. Needs one EulerImplicitSolver above both.",
    .templates = kVec3Templates,
    .attributes = kTissueContactAttributes};

}  // namespace hexaplast::attributes
