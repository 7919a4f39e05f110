// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Our own components but bodies and shapes, the same in every host.
namespace hexaplast::attributes {

inline constexpr Attribute kMultigridCGLinearSolverAttributes[] = {
    {.name = "preconditioner",
     .type = Type::kWord,
     .initial = "auto",
     .words = "auto multigrid diagonal",
     .help = "multigrid: a cycle over coarser meshes, as many iterations whatever the size, few where cells are not "
             "flat; needs hexahedra that form a lattice, as grids, tubes, shells and cages do, else the diagonal takes "
             "its place. diagonal: cheaper where a pressure wave passes fewer than "
             "about four hexahedra in a time step. auto: the cheaper one."},
    {.name = "tolerance",
     .type = Type::kReal,
     .initial = "0.01",
     .range = {.least = 0, .most = 1, .without_least = true},
     .help = "Ends when |r| / |b| is not greater."},
    {.name = "iterations",
     .type = Type::kInteger,
     .initial = "500",
     .range = {.least = 1, .most = 1000000000},
     .help = "Largest number of iterations."},
};
inline constexpr Description kMultigridCGLinearSolver{
    .class_name = "MultigridCGLinearSolver",
    .category = "LinearSolver",
    .help = "Preconditioned conjugate gradients that end when the answer is as good as asked for.",
    .attributes = kMultigridCGLinearSolverAttributes};

inline constexpr Attribute kTangentialForceAttributes[] = {
    {.name = "indices", .type = Type::kIntegers, .range = kIndex, .help = "Nodes, group after group."},
    {.name = "groupSize",
     .type = Type::kInteger,
     .initial = "1",
     .range = {.least = 1, .most = 2147483646},
     .help = "Consecutive indices that form a group: 1 for nodes, 2 for the centres of edges."},
    {.name = "axis",
     .type = Type::kVector3,
     .initial = "0 0 1",
     .help = "Direction of the axis; its length is irrelevant."},
    {.name = "centre", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "A point on the axis."},
    {.name = "times", .type = Type::kReals, .unit = "s", .help = "Key times, ascending."},
    {.name = "forces",
     .type = Type::kReals,
     .unit = "N",
     .help = "Size of the force on each group at each key time: none before the first time, linear in between, the "
             "last one from the last time on. Evaluated at the beginning of a step."},
};
inline constexpr Description kTangentialForceField{
    .class_name = "TangentialForceField",
    .category = "ForceField",
    .help =
        "Forces around an axis that turn with the body. The force on a group acts along axis x (p - centre), p being "
        "the mean of the group's present positions, and is shared equally by its nodes.",
    .templates = kVec3Templates,
    .attributes = kTangentialForceAttributes};

inline constexpr Attribute kGraspAttributes[] = {
    {.name = "keyTimes", .type = Type::kReals, .unit = "s", .help = "Key times of the tool's path, ascending."},
    {.name = "positions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Where the tool is at each key time, linear in between; it stays at the first position before the first "
             "time and at the last one after the last. Evaluated at the beginning of a step."},
    {.name = "graspTime",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "The grip closes at the beginning of the first step from this time on."},
    {.name = "releaseTime",
     .type = Type::kReal,
     .unit = "s",
     .range = kPositive,
     .help = "The grip opens at the beginning of the first step from this time on. Without it, never."},
    {.name = "radius",
     .type = Type::kReal,
     .unit = "m",
     .range = kPositive,
     .help =
         "The grip holds the nodes that are as near to the tool when it closes. Where there are none a warning says "
         "so."},
    {.name = "indices",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Nodes that can be held; all where not given."},
    {.name = "stiffness",
     .type = Type::kReal,
     .initial = "1000",
     .unit = "N/m",
     .range = kPositive,
     .help = "Of the grip as a whole: each of n held nodes is tied by a spring of 1/n of it to the place that it had, "
             "relative to the tool, when the grip closed."},
    {.name = "maxForce",
     .type = Type::kReal,
     .unit = "N",
     .range = kPositive,
     .help = "Limit of the grip as a whole: no spring pulls harder than 1/n of it, and its node then lags behind the "
             "tool. Without it there is no limit."},
    {.name = "damping",
     .type = Type::kReal,
     .initial = "0",
     .unit = "N s/m",
     .range = kNotNegative,
     .help =
         "Of the grip as a whole: beside each spring stands a dashpot of 1/n of it, against the velocity of the node "
         "relative to the tool; maxForce does not limit it."},
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Stiffness-proportional damping in the system matrix alone, besides the solver's own."},
    {.name = "grasped", .type = Type::kIntegers, .access = Access::kOutput, .help = "Nodes that the grip holds now."},
    {.name = "force",
     .type = Type::kVector3,
     .unit = "N",
     .access = Access::kOutput,
     .help = "What the tool exerted on the body at the beginning of the latest step."},
};
inline constexpr Description kGraspForceField{
    .class_name = "GraspForceField",
    .category = "ForceField",
    .help =
        "An instrument: takes hold of the nodes around it, moves along a path and lets go, with a limited force. It "
        "acts "
        "on the nearest state, which may be one of embedded points. In SOFA, LinearMovementProjectiveConstraint moves "
        "chosen nodes exactly and frees them at its last key time; RestShapeSpringsForceField, with "
        "external_rest_shape "
        "on points that such a constraint moves, ties them by springs, and AttachProjectiveConstraint rigidly; none of "
        "them chooses nodes during the run or limits the force.",
    .templates = kVec3Templates,
    .attributes = kGraspAttributes};

inline constexpr Attribute kRunSettingsAttributes[] = {
    {.name = "steps",
     .type = Type::kInteger,
     .range = {.least = 0, .most = 1e9},
     .help = "Number of time steps of a run, unless the command line gives one."},
    {.name = "outputEvery",
     .type = Type::kInteger,
     .initial = "25",
     .range = {.least = 1, .most = 1e9},
     .help = "Steps between two saved states."},
};
inline constexpr Description kRunSettings{.class_name = "RunSettings",
                                          .category = "Settings",
                                          .help = "How long a scene runs and how often its state is saved.",
                                          .attributes = kRunSettingsAttributes};

}  // namespace hexaplast::attributes
