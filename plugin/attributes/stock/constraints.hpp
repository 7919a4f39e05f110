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
constexpr Attribute project_velocity(std::string_view name) {
  return {.name = name,
          .type = Type::kBool,
          .initial = "false",
          .help = "Also takes away the velocity that a node begins with."};
}
// Outputs that SOFA's constraints do not have.
inline constexpr Attribute kReaction{
    .name = "reaction",
    .type = Type::kVector3,
    .unit = "N",
    .access = Access::kOutput,
    .help =
        "Sum of the forces of constraints on its nodes in the last step, in the directions that are held; jumps of a "
        "prescribed velocity come on top. Of EulerImplicitSolver only, and not in SOFA."};
inline constexpr Attribute kReactionTorque{.name = "reactionTorque",
                                           .type = Type::kVector3,
                                           .unit = "N m",
                                           .access = Access::kOutput,
                                           .help = "Moment of these forces about the origin."};
inline constexpr Attribute kConstraintTopology =
    ignored_attribute("topology", "Ignored here: nodes keep their numbers.");

inline constexpr Attribute kFixedProjectiveConstraintAttributes[] = {
    kFixedIndices,
    kFixAll,
    project_velocity("activate_projectVelocity"),
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
    project_velocity("projectVelocity"),
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
        "Movement at each key time, linear in between. Nodes are free before the first time and from the last one on: "
        "to hold them, repeat the last movement at a far later time."};

inline constexpr Attribute kLinearMovementProjectiveConstraintAttributes[] = {
    kMovedIndices,
    kKeyTimes,
    kMovements,
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    visual_attribute("showMovement"),
};
inline constexpr Description kLinearMovementProjectiveConstraint{
    .class_name = "LinearMovementProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help = "Moves nodes along a history. A step from t to t + dt ends with the movement at t, as in SOFA.",
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
        "Moves nodes along a history in some directions. In the others they keep their velocity (SOFA overwrites it).",
    .templates = kVec3Templates,
    .attributes = kPartialLinearMovementProjectiveConstraintAttributes};

inline constexpr Attribute kAttachProjectiveConstraintAttributes[] = {
    {.name = "object1",
     .type = Type::kLink,
     .help = "The mechanical state that the other one follows; default: that of the node. Without twoWay it may be a "
             "mapped one."},
    {.name = "object2",
     .type = Type::kLink,
     .help = "The mechanical state whose nodes are tied to it; default: that of the node. One time integrator moves "
             "both."},
    {.name = "indices1", .type = Type::kIntegers, .range = kIndex, .help = "Nodes of object1."},
    {.name = "indices2", .type = Type::kIntegers, .range = kIndex, .help = "Nodes of object2, as many, each once."},
    {.name = "twoWay",
     .type = Type::kBool,
     .initial = "false",
     .help = "Both nodes of a pair have the mean of their accelerations, and forces pass between the states; not with "
             "direct solvers. Otherwise the second node does not accelerate, and no force passes."},
    ignored_attribute("freeRotations", "Ignored here: nodes do not turn."),
    ignored_attribute("lastFreeRotation", "Ignored here: nodes do not turn."),
    ignored_attribute("restRotations", "Ignored here: nodes do not turn."),
};
inline constexpr Description kAttachProjectiveConstraint{
    .class_name = "AttachProjectiveConstraint",
    .category = "InteractionProjectiveConstraint",
    .help =
        "Ties nodes of two mechanical states. As in SOFA, the distance of a pair is halved in every step, and both get "
        "the mean of their velocities.",
    .templates = kVec3Templates,
    .attributes = kAttachProjectiveConstraintAttributes};

}  // namespace hexaplast::attributes
