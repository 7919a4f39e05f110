// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Prescribed motion. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kFixedIndices{.name = "indices",
                                         .type = Type::kIntegers,
                                         .initial = "0",
                                         .range = kIndex,
                                         .help = "Nodes that receive no acceleration."};
inline constexpr Attribute kFixAll{
    .name = "fixAll", .type = Type::kBool, .initial = "false", .help = "Fixes every node."};
inline constexpr Attribute kProjectVelocity{.name = "activate_projectVelocity",
                                            .type = Type::kBool,
                                            .initial = "false",
                                            .aliases = "projectVelocity",
                                            .help = "Also takes away the velocity that a node begins with."};
// Outputs that SOFA's constraints do not have.
inline constexpr Attribute kReaction{
    .name = "reaction",
    .type = Type::kVector3,
    .unit = "N",
    .access = Access::kOutput,
    .help =
        "Sum of the forces on its nodes by which constraints held or prescribed them in the last step: what the "
        "equation "
        "of the step lacks in the directions that are held. Jumps of a prescribed velocity come on top. Only "
        "EulerImplicitSolver tells it. SOFA has no such output."};
inline constexpr Attribute kReactionTorque{
    .name = "reactionTorque",
    .type = Type::kVector3,
    .unit = "N m",
    .access = Access::kOutput,
    .help = "Moment of these forces about the origin; about another point p it is reactionTorque - p x reaction."};
inline constexpr Attribute kConstraintTopology =
    ignored_attribute("topology", "Ignored here: nodes keep their numbers.");

inline constexpr Attribute kFixedProjectiveConstraintAttributes[] = {
    kFixedIndices,
    kFixAll,
    kProjectVelocity,
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    visual_attribute("showObject"),
    visual_attribute("drawSize"),
};
inline constexpr Description kFixedProjectiveConstraint{
    .class_name = "FixedProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help = "Holds nodes: their acceleration is zero, so that a velocity they begin with persists.",
    .templates = kVec3Templates,
    .attributes = kFixedProjectiveConstraintAttributes};

inline constexpr Attribute kPartialFixedProjectiveConstraintAttributes[] = {
    kFixedIndices,
    kFixAll,
    {.name = "fixedDirections",
     .type = Type::kIntegers,
     .initial = "1 1 1",
     .range = {.min = 0, .max = 1},
     .help = "1 for each of x, y, z that is held, 0 where nodes move freely."},
    kProjectVelocity,
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    visual_attribute("showObject"),
    visual_attribute("drawSize"),
};
inline constexpr Description kPartialFixedProjectiveConstraint{
    .class_name = "PartialFixedProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help = "Holds nodes in some directions.",
    .templates = kVec3Templates,
    .attributes = kPartialFixedProjectiveConstraintAttributes};

inline constexpr Attribute kMovedIndices{
    .name = "indices", .type = Type::kIntegers, .initial = "0", .range = kIndex, .help = "Nodes that are moved."};
inline constexpr Attribute kKeyTimes{
    .name = "keyTimes", .type = Type::kReals, .initial = "0", .unit = "s", .help = "Key times, ascending."};
inline constexpr Attribute kMovements{
    .name = "movements",
    .type = Type::kVectors3,
    .initial = "0 0 0",
    .unit = "m",
    .help =
        "Movement at each key time, linear in between. Before the first time and from the last one on the nodes are "
        "free: to hold them, repeat the last movement at a far later time."};

inline constexpr Attribute kLinearMovementProjectiveConstraintAttributes[] = {
    kMovedIndices,
    kKeyTimes,
    kMovements,
    {.name = "relativeMovements",
     .type = Type::kBool,
     .initial = "true",
     .help = "Movements count from the first position of each node; otherwise they are the position itself."},
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    visual_attribute("showMovement"),
};
inline constexpr Description kLinearMovementProjectiveConstraint{
    .class_name = "LinearMovementProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help =
        "Moves nodes along a history. A step from t to t + dt ends with the movement at t: the motion lags by one "
        "step, as in SOFA.",
    .templates = kVec3Templates,
    .attributes = kLinearMovementProjectiveConstraintAttributes};

inline constexpr Attribute kPartialLinearMovementProjectiveConstraintAttributes[] = {
    kMovedIndices,
    kKeyTimes,
    kMovements,
    {.name = "movedDirections",
     .type = Type::kIntegers,
     .initial = "1 1 1",
     .range = {.min = 0, .max = 1},
     .help = "1 for each of x, y, z in which nodes are moved, 0 where they are free."},
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    {.name = "linearMovementBetweenNodesInIndices",
     .type = Type::kWord,
     .initial = "false",
     .words = "false 0",
     .help = "Only false here."},
    visual_attribute("showMovement"),
};
inline constexpr Description kPartialLinearMovementProjectiveConstraint{
    .class_name = "PartialLinearMovementProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help =
        "Moves nodes along a history in some directions, as LinearMovementProjectiveConstraint does in all. In the "
        "other directions nodes keep their velocity (SOFA overwrites it there too).",
    .templates = kVec3Templates,
    .attributes = kPartialLinearMovementProjectiveConstraintAttributes};

inline constexpr Attribute kAttachProjectiveConstraintAttributes[] = {
    {.name = "object1",
     .type = Type::kLink,
     .help = "The mechanical state that the other one follows; default: that of the node. Without twoWay it may follow "
             "another one."},
    {.name = "object2",
     .type = Type::kLink,
     .help = "The mechanical state whose nodes are tied to it; default: that of the node. One time integrator moves "
             "both."},
    {.name = "indices1", .type = Type::kIntegers, .range = kIndex, .help = "Nodes of object1."},
    {.name = "indices2", .type = Type::kIntegers, .range = kIndex, .help = "Nodes of object2, as many, each once."},
    {.name = "twoWay",
     .type = Type::kBool,
     .initial = "false",
     .help = "Both nodes of a pair have half of their accelerations: they move as one, and forces pass between the "
             "states. Not for direct solvers, whose matrix has no such constraint. Otherwise the second node does not "
             "accelerate, and no force passes."},
    {.name = "constraintFactor",
     .type = Type::kReals,
     .range = {.min = 0, .max = 1},
     .help = "One value per pair; default: 1. With twoWay 0 (not tied) or 1. Otherwise a factor of the corrections of "
             "position and velocity."},
    {.name = "positionFactor",
     .type = Type::kReal,
     .initial = "1",
     .range = {.min = 0, .max = 1},
     .help = "Of half the distance of a pair, by which the second node is moved to the first one after every step."},
    {.name = "velocityFactor",
     .type = Type::kReal,
     .initial = "1",
     .range = {.min = 0, .max = 1},
     .help = "Of half the difference of both velocities, by which both change after every step."},
    {.name = "minDistance",
     .type = Type::kReal,
     .initial = "-1",
     .unit = "m",
     .help = "Pairs further apart than this are not tied, until they are nearer; -1: all are."},
    {.name = "endTime",
     .type = Type::kReal,
     .initial = "-1",
     .unit = "s",
     .help = "From then on nothing is tied; below 0: never."},
    ignored_attribute("freeRotations", "Ignored here: nodes do not turn."),
    ignored_attribute("lastFreeRotation", "Ignored here: nodes do not turn."),
    ignored_attribute("restRotations", "Ignored here: nodes do not turn."),
};
inline constexpr Description kAttachProjectiveConstraint{
    .class_name = "AttachProjectiveConstraint",
    .category = "InteractionProjectiveConstraint",
    .help =
        "Ties nodes of two mechanical states to each other. As in SOFA, the distance of a pair is halved in every "
        "step, and both get the mean of their velocities.",
    .templates = kVec3Templates,
    .attributes = kAttachProjectiveConstraintAttributes};

}  // namespace hexaplast::attributes
