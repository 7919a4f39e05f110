// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Prescribed motion. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kFixedIndices = indices("indices", {.initial = "0"}, "Nodes that receive no acceleration.");
inline constexpr Attribute kFixAll = boolean("fixAll", {.initial = "false"}, "Fixes every node.");
constexpr Attribute project_velocity(std::string_view name) {
  return {.name = name,
          .type = Type::kBool,
          .initial = "false",
          .help = "Also takes away the velocity that a node begins with."};
}
// Outputs that SOFA's constraints do not have.
inline constexpr Attribute kReaction =
    output(vector3("reaction", {.unit = "N"},
                   "Sum of the forces of constraints on its nodes in the last step, in the directions that are held; "
                   "jumps of a prescribed velocity come on top. Of EulerImplicitSolver only, and not in SOFA."));
inline constexpr Attribute kReactionTorque =
    output(vector3("reactionTorque", {.unit = "N m"}, "Moment of these forces about the origin."));
inline constexpr Attribute kConstraintTopology =
    ignored_attribute("topology", "Ignored here: nodes keep their numbers.");

inline constexpr std::array kFixedProjectiveConstraintAttributes = {
    kFixedIndices,
    kFixAll,
    project_velocity("activate_projectVelocity"),
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    visual_attribute("showObject"),
    visual_attribute("drawSize"),
};
inline constexpr Description kFixedProjectiveConstraint =
    projective_constraint("FixedProjectiveConstraint",
                          "Holds nodes: their acceleration is zero, so that a velocity they begin with persists.",
                          kFixedProjectiveConstraintAttributes);

inline constexpr std::array kPartialFixedProjectiveConstraintAttributes = {
    kFixedIndices,
    kFixAll,
    integers("fixedDirections", {.initial = "1 1 1", .range = {.min = 0, .max = 1}},
             "1 for each of x, y, z that is held, 0 where nodes move freely."),
    project_velocity("projectVelocity"),
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    visual_attribute("showObject"),
    visual_attribute("drawSize"),
};
inline constexpr Description kPartialFixedProjectiveConstraint = projective_constraint(
    "PartialFixedProjectiveConstraint", "Holds nodes in some directions.", kPartialFixedProjectiveConstraintAttributes);

inline constexpr Attribute kMovedIndices = indices("indices", {.initial = "0"}, "Nodes that are moved.");
inline constexpr Attribute kKeyTimes = reals("keyTimes", {.initial = "0", .unit = "s"}, "Key times, ascending.");
inline constexpr Attribute kMovements =
    vectors3("movements", {.initial = "0 0 0", .unit = "m"},
             "Movement at each key time, linear in between. Nodes are free before the first time and from the last one "
             "on: to hold them, repeat the last movement at a far later time.");

inline constexpr std::array kLinearMovementProjectiveConstraintAttributes = {
    kMovedIndices,
    kKeyTimes,
    kMovements,
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    visual_attribute("showMovement"),
};
inline constexpr Description kLinearMovementProjectiveConstraint = projective_constraint(
    "LinearMovementProjectiveConstraint",
    "Moves nodes along a history. A step from t to t + dt ends with the movement at t, as in SOFA.",
    kLinearMovementProjectiveConstraintAttributes);

inline constexpr std::array kPartialLinearMovementProjectiveConstraintAttributes = {
    kMovedIndices,
    kKeyTimes,
    kMovements,
    integers("movedDirections", {.initial = "1 1 1", .range = {.min = 0, .max = 1}},
             "1 for each of x, y, z in which nodes are moved, 0 where they are free."),
    kConstraintTopology,
    kReaction,
    kReactionTorque,
    one_of("linearMovementBetweenNodesInIndices", {.initial = "false", .words = "false 0"}, "Only false here."),
    visual_attribute("showMovement"),
};
inline constexpr Description kPartialLinearMovementProjectiveConstraint = projective_constraint(
    "PartialLinearMovementProjectiveConstraint",
    "Moves nodes along a history in some directions. In the others they keep their velocity (SOFA overwrites it).",
    kPartialLinearMovementProjectiveConstraintAttributes);

inline constexpr std::array kAttachProjectiveConstraintAttributes = {
    link("object1",
         "The mechanical state that the other one follows; default: that of the node. Without twoWay it may be a "
         "mapped one."),
    link("object2",
         "The mechanical state whose nodes are tied to it; default: that of the node. One time integrator moves both."),
    indices("indices1", "Nodes of object1."),
    indices("indices2", "Nodes of object2, as many, each once."),
    boolean("twoWay", {.initial = "false"},
            "Both nodes of a pair have the mean of their accelerations, and forces pass between the states; not with "
            "direct solvers. Otherwise the second node does not accelerate, and no force passes."),
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
