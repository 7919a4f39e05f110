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
                                                    "contactStiffness; at most 200 times the default of that.",
                                                .group = "Contact"};
inline constexpr Attribute kFriction{
    .name = "friction",
    .type = Type::kReal,
    .initial = "0",
    .range = kNotNegative,
    .help = "Tissue slips where the tangential force exceeds this times the normal force.",
    .group = "Contact"};
inline constexpr Attribute kContactDistance{
    .name = "contactDistance",
    .type = Type::kReal,
    .initial = "0",
    .unit = "m",
    .range = kNotNegative,
    .help = "Contact begins at this distance from the surface: at most half of the mean edge.",
    .group = "Contact"};
inline constexpr Attribute kContactDamping{
    .name = "damping",
    .type = Type::kReal,
    .initial = "0",
    .unit = "Pa s/m",
    .range = kNotNegative,
    .help = "Pressure per speed of approach; at most 200 times the default of contactStiffness times dt.",
    .group = "Contact"};

inline constexpr Attribute kActive{.name = "active",
                                   .type = Type::kBool,
                                   .initial = "true",
                                   .help = "false: they pass through each other.",
                                   .group = "Contact"};

inline constexpr Attribute kInstrumentContactAttributes[] = {
    {.name = "shape",
     .type = Type::kWord,
     .initial = "sphere",
     .words = "sphere capsule cylinder box surface",
     .help = "Shape around the origin of the instrument's frame. Capsules and cylinders lie along z. surface: that of "
             "surfaceTriangles.",
     .group = "Instrument"},
    {.name = "radius",
     .type = Type::kReal,
     .unit = "m",
     .range = kPositive,
     .help = "Of sphere, capsule, cylinder.",
     .group = "Instrument"},
    {.name = "length",
     .type = Type::kReal,
     .unit = "m",
     .range = kPositive,
     .help = "Of cylinder and capsule; of a capsule without its two caps.",
     .group = "Instrument"},
    {.name = "size",
     .type = Type::kVector3,
     .unit = "m",
     .range = kPositive,
     .help = "Edges of the box.",
     .group = "Instrument"},
    {.name = "surfacePositions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Nodes of the surface in the frame of the instrument: @loader.position.",
     .group = "Instrument"},
    {.name = "surfaceTriangles",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "A closed surface: groups of three nodes, counter-clockwise seen from outside.",
     .group = "Instrument"},
    {.name = "embeddedPositions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Nodes, in the initial shape, of a surface that is embedded in the body: @visual.position.",
     .group = "Contact"},
    {.name = "embeddedTriangles",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Groups of three of these nodes, counter-clockwise seen from outside: the surface that is touched, in "
             "place of the faces of the hexahedra.",
     .group = "Contact"},
    {.name = "keyTimes",
     .type = Type::kReals,
     .unit = "s",
     .help = "Key times of the path, ascending.",
     .group = "Path"},
    {.name = "positions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Position at each key time, linear in between; constant before the first time and after the last.",
     .group = "Path"},
    {.name = "orientations",
     .type = Type::kReals,
     .help = "Orientation at each key time, a quaternion x y z w; it turns steadily in between. Default: not turned.",
     .group = "Path"},
    {.name = "contactStiffness",
     .type = Type::kReal,
     .unit = "Pa/m",
     .range = kPositive,
     .help = "Pressure per depth of penetration. Default: 30 times the greatest Young's modulus over the mean edge of "
             "the hexahedra, also when the modulus changes. At most 200 times the default; from 30 times on a "
             "MultigridCGLinearSolver needs a tolerance of 1e-8.",
     .group = "Contact"},
    kTangentialStiffness,
    kFriction,
    kContactDistance,
    kContactDamping,
    {.name = "maxSubdivision",
     .type = Type::kInteger,
     .initial = "8",
     .range = {.min = 1, .max = 64},
     .help = "Contact points divide edges into parts of half the instrument's smallest radius, but at most this number "
             "of parts; a warning appears if it does not suffice.",
     .group = "Contact"},
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
     .help = "Largest depth of the surface in the instrument."},
    {.name = "touching", .type = Type::kReals, .access = Access::kOutput, .help = "Number of points that touch."},
    {.name = "slipping", .type = Type::kReals, .access = Access::kOutput, .help = "How many of these slip."},
};
inline constexpr Description kInstrumentContactForceField{
    .class_name = "InstrumentContactForceField",
    .category = "ForceField",
    .help =
        "A rigid instrument that moves along a path and touches the nearest body: it presses and drags by friction, "
        "and never pulls. Needs an EulerImplicitSolver.",
    .templates = kVec3Templates,
    .attributes = kInstrumentContactAttributes};

/// What it has in SOFA besides: a rigid frame of a scene in place of its path.
inline constexpr Attribute kInstrumentFrameAttributes[] = {
    {.name = "rigid",
     .type = Type::kLink,
     .help = "In place of a path: a MechanicalObject of rigid frames (template Rigid3d), or its node. One frame "
             "prescribes the motion of the instrument, which the body does not push. Within a step the instrument "
             "moves on with the velocity of the frame."},
    {.name = "rigidIndex",
     .type = Type::kInteger,
     .initial = "0",
     .range = kIndex,
     .help = "Which of the frames.",
     .group = "Path"},
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
     .help = "That of the other body. Default: the same body, which touches itself, except within two hexahedra."},
    {.name = "contactStiffness",
     .type = Type::kReal,
     .unit = "Pa/m",
     .range = kPositive,
     .help = "Pressure per depth of penetration. Default and limits as of InstrumentContactForceField, for the body "
             "for which they are less.",
     .group = "Contact"},
    kTangentialStiffness,
    kFriction,
    kContactDistance,
    kContactDamping,
    {.name = "maxSubdivision",
     .type = Type::kInteger,
     .initial = "8",
     .range = {.min = 1, .max = 64},
     .help = "Contact points divide edges into parts of half the mean edge of the other surface, but at most this "
             "number of parts.",
     .group = "Contact"},
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
     .help = "Largest depth of a surface in the other."},
    {.name = "touching", .type = Type::kReals, .access = Access::kOutput, .help = "Number of points that touch."},
    {.name = "slipping", .type = Type::kReals, .access = Access::kOutput, .help = "How many of these slip."},
};
inline constexpr Description kTissueContactForceField{
    .class_name = "TissueContactForceField",
    .category = "InteractionForceField",
    .help = "Two bodies that touch each other, or one that touches itself. Needs one EulerImplicitSolver above both.",
    .templates = kVec3Templates,
    .attributes = kTissueContactAttributes};

}  // namespace hexaplast::attributes
