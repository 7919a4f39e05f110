// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"
#include "attributes/stock/mappings.hpp"
#include "attributes/stock/masses.hpp"

/// Rigid frames: what SOFA has under template Rigid3d. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr std::string_view kRigid = "Rigid3d";
inline constexpr std::string_view kRigidTemplates = "Rigid3 Rigid3d Rigid";

inline constexpr Attribute kRigidObjectAttributes[] = {
    {.name = "position",
     .type = Type::kReals,
     .access = Access::kState,
     .help = "Seven numbers for each frame: its origin [m], then its orientation, a unit quaternion x y z w. Points of "
             "the topology, not turned, where none is given, where one is given beside a topology in the same node, or "
             "where a link leads to points."},
    {.name = "velocity",
     .type = Type::kVectors3,
     .access = Access::kState,
     .help = "Six numbers for each frame: velocity [m/s] and angular velocity [rad/s]. Default: at rest."},
    {.name = "externalForce",
     .type = Type::kVectors3,
     .help = "Six numbers for each frame: constant force [N] and moment [N m]."},
    {.name = "rotation",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "deg",
     .help = "About x, then y, then z: turns origins and orientations."},
    {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
    {.name = "topology",
     .type = Type::kLink,
     .help = "Source of the origins; default: the topology of the node, or of the nearest one above."},
    {.name = "scale3d",
     .type = Type::kVector3,
     .initial = "1 1 1",
     .range = {.min = 1, .max = 1},
     .help = "Only 1 1 1 here: frames have no size."},
    ignored_attribute("size", "Ignored here: there are as many frames as positions."),
    ignored_attribute("force", "Ignored here: computed."),
    ignored_attribute("restScale", "Ignored here: frames have no size."),
    visual_attribute("showObject"),
    visual_attribute("showObjectScale"),
    visual_attribute("showIndices"),
    visual_attribute("showIndicesScale"),
    visual_attribute("showVectors"),
    visual_attribute("showVectorsScale"),
    visual_attribute("showColor"),
    visual_attribute("drawMode"),
};
inline constexpr Description kRigidObject{
    .class_name = "MechanicalObject",
    .category = "MechanicalState",
    .help =
        "Rigid frames, free or prescribed, each with six degrees of freedom. Points follow them by a RigidMapping. For "
        "EulerImplicitSolver and the explicit integrators.",
    .templates = kRigidTemplates,
    .attributes = kRigidObjectAttributes,
    .variant = kRigid};

inline constexpr Attribute kRigidMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Divided equally among all frames; their inertia is that of vertexMass for this mass."},
    {.name = "vertexMass",
     .type = Type::kText,
     .help =
         "Of each frame: its mass [kg]; or eleven numbers: mass, volume (not used) and nine of its inertia matrix "
         "divided by the mass [m^2], row by row. Commas and square brackets may stand between them. Default inertia: "
         "1 m^2 about each axis."},
    kMassRayleigh,
    kSeparateGravity,
    ignored_attribute("preserveTotalMass", "Ignored here: frames stay."),
    ignored_attribute("filename", "Ignored here: no files of masses are read."),
    visual_attribute("showGravityCenter"),
    visual_attribute("showAxisSizeFactor"),
};
inline constexpr Description kRigidMass{
    .class_name = "UniformMass",
    .category = "Mass",
    .help =
        "The same mass and inertia at every frame. As in SOFA the inertia matrix keeps the axes of the world when a "
        "frame turns, and there are no gyroscopic moments.",
    .templates = "Rigid3 Rigid3d Rigid Rigid3,double Rigid3d,double Rigid3d,RigidMass",
    .attributes = kRigidMassAttributes,
    .variant = kRigid};

inline constexpr Attribute kRigidFixedAttributes[] = {
    {.name = "indices", .type = Type::kIntegers, .initial = "0", .range = kIndex, .help = "Frames."},
    {.name = "fixAll", .type = Type::kBool, .initial = "false", .help = "Fixes all frames; indices are ignored."},
    {.name = "activate_projectVelocity",
     .type = Type::kBool,
     .initial = "false",
     .help = "Whether velocities are set to 0 as well, which otherwise keep what they begin with."},
    visual_attribute("showObject"),
    visual_attribute("drawSize"),
};
inline constexpr Description kRigidFixed{.class_name = "FixedProjectiveConstraint",
                                         .category = "ProjectiveConstraint",
                                         .help = "Frames that neither move nor turn.",
                                         .templates = kRigidTemplates,
                                         .attributes = kRigidFixedAttributes,
                                         .variant = kRigid};

inline constexpr Attribute kRigidMovementAttributes[] = {
    {.name = "indices", .type = Type::kIntegers, .initial = "0", .range = kIndex, .help = "Frames."},
    {.name = "keyTimes", .type = Type::kReals, .unit = "s", .help = "Ascending."},
    {.name = "movements",
     .type = Type::kVectors3,
     .help = "Six numbers for each key time: translation [m] and rotation [rad] about x, then y, then z. In between "
             "frames move along straight lines and turn steadily."},
    {.name = "relativeMovements",
     .type = Type::kBool,
     .initial = "true",
     .help = "Whether movements count from where a frame begins, rotations in its own axes; otherwise they are poses."},
    visual_attribute("showMovement"),
};
inline constexpr Description kRigidMovement{
    .class_name = "LinearMovementProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help =
        "Frames that move along a prescribed path. Before the first key time and from the last one on they are free.",
    .templates = kRigidTemplates,
    .attributes = kRigidMovementAttributes,
    .variant = kRigid};

inline constexpr Attribute kRigidSpringsAttributes[] = {
    {.name = "points", .type = Type::kIntegers, .range = kIndex, .aliases = "indices", .help = "Frames; default: all."},
    {.name = "stiffness",
     .type = Type::kReals,
     .initial = "100",
     .unit = "N/m",
     .range = kNotNegative,
     .help = "One value, or one per frame."},
    {.name = "angularStiffness",
     .type = Type::kReals,
     .initial = "100",
     .unit = "N m/rad",
     .range = kNotNegative,
     .help = "One value, or one per frame."},
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Damping by their stiffness, in the system matrix alone."},
    visual_attribute("drawSpring"),
    visual_attribute("springColor"),
};
inline constexpr Description kRigidSprings{.class_name = "RestShapeSpringsForceField",
                                           .category = "ForceField",
                                           .help = "Springs that pull frames to where they begin, and turn them back.",
                                           .templates = kRigidTemplates,
                                           .attributes = kRigidSpringsAttributes,
                                           .variant = kRigid};

inline constexpr Attribute kRigidMappingAttributes[] = {
    {.name = "input",
     .type = Type::kLink,
     .help = "The rigid frames that are followed, or their node; default: those of the nearest node above."},
    kMappingOutput,
    {.name = "initialPoints",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "The points in their frames; default: the positions of the mapped state."},
    {.name = "globalToLocalCoords",
     .type = Type::kBool,
     .initial = "false",
     .help = "Whether the positions of the mapped state are in the axes of the world; otherwise in their frames."},
    {.name = "index", .type = Type::kInteger, .initial = "0", .range = kIndex, .help = "The frame of all points."},
    {.name = "indexFromEnd", .type = Type::kBool, .initial = "false", .help = "Whether index counts from the end."},
    {.name = "rigidIndexPerPoint",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "The frame of each point. Has no effect unless there are as many as points."},
    {.name = "geometricStiffness",
     .type = Type::kWord,
     .initial = "0",
     .words = "0 None",
     .help =
         "Only 0 here: the stiffness of the points is carried up, and not what their forces have when a frame turns."},
    {.name = "useX0", .type = Type::kWord, .initial = "false", .words = "false 0", .help = "Only false here."},
    ignored_attribute("mapForces", "Ignored here: forces are always carried up."),
    ignored_attribute("mapMasses", "Ignored here: masses are always carried up."),
    ignored_attribute("mapConstraints", "Ignored here: there are no Lagrangian constraints."),
};
inline constexpr Description kRigidMapping{
    .class_name = "RigidMapping",
    .category = "Mapping",
    .help =
        "Points that move with rigid frames. Forces, masses and stiffness of the points act on the frames. An "
        "OglModel that follows is not shown.",
    .templates = "Rigid,Vec3d Rigid,Vec3 Rigid3,Vec3 Rigid3d,Vec3d Rigid3d,Vec3 Rigid3,Vec3d",
    .attributes = kRigidMappingAttributes};

}  // namespace hexaplast::attributes
