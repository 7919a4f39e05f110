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
     .help = "multigrid: a V-cycle on coarser meshes; the number of iterations does not depend on the size, and is "
             "small where cells are not flat. Needs hexahedra that form a lattice (grids, tubes, shells, cages); "
             "otherwise the diagonal is used. diagonal: cheaper if a pressure wave travels less than about four "
             "hexahedra in a time step. auto: the cheaper one."},
    {.name = "tolerance",
     .type = Type::kReal,
     .initial = "0.01",
     .range = {.min = 0, .max = 1, .exclusive_min = true},
     .help = "Stops when |r| / |b| <= this value, for each of the independent states that it solves for: |b| is the "
             "load of the state, or the force that contact and springs transmit to it where that is larger."},
    {.name = "iterations",
     .type = Type::kInteger,
     .initial = "500",
     .range = {.min = 1, .max = 1000000000},
     .help = "Largest number of iterations."},
};
inline constexpr Description kMultigridCGLinearSolver{
    .class_name = "MultigridCGLinearSolver",
    .category = "LinearSolver",
    .help = "Preconditioned conjugate gradients with a relative tolerance.",
    .attributes = kMultigridCGLinearSolverAttributes};

inline constexpr Attribute kTangentialForceAttributes[] = {
    {.name = "indices", .type = Type::kIntegers, .range = kIndex, .help = "Nodes, group after group."},
    {.name = "groupSize",
     .type = Type::kInteger,
     .initial = "1",
     .range = {.min = 1, .max = 2147483646},
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
        "the mean of the group's current positions, and is divided equally among its nodes.",
    .templates = kVec3Templates,
    .attributes = kTangentialForceAttributes};

inline constexpr Attribute kGraspAttributes[] = {
    {.name = "keyTimes", .type = Type::kReals, .unit = "s", .help = "Key times of the tool's path, ascending."},
    {.name = "positions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Position of the tool at each key time, linear in between; it stays at the first position before the "
             "first time and at the last one after the last. Evaluated at the beginning of a step."},
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
         "Radius around the tool in which the grip holds nodes when it closes. A warning appears if there are none."},
    {.name = "indices", .type = Type::kIntegers, .range = kIndex, .help = "Nodes that can be held; default: all."},
    {.name = "stiffness",
     .type = Type::kReal,
     .initial = "1000",
     .unit = "N/m",
     .range = kPositive,
     .help = "Stiffness of the whole grip. Each of n held nodes has a spring of 1/n of it to its place relative to the "
             "tool when the grip closed."},
    {.name = "maxForce",
     .type = Type::kReal,
     .unit = "N",
     .range = kPositive,
     .help = "Maximum force of the whole grip. Each spring pulls with at most 1/n of it; its node then stays behind "
             "the tool. Without it there is no limit."},
    {.name = "damping",
     .type = Type::kReal,
     .initial = "0",
     .unit = "N s/m",
     .range = kNotNegative,
     .help = "Damping of the whole grip. A dashpot of 1/n of it is parallel to each spring and acts against the "
             "velocity of the node relative to the tool. maxForce does not limit it."},
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
     .help = "Force of the tool on the body at the beginning of the last step."},
    {.name = "torque",
     .type = Type::kVector3,
     .unit = "N m",
     .access = Access::kOutput,
     .help = "Moment of that force about the tool. About another point p it is torque + (tool - p) x force."},
};
inline constexpr Description kGraspForceField{
    .class_name = "GraspForceField",
    .category = "ForceField",
    .help =
        "An instrument: it grasps the nodes around it, moves along a path and releases them, with a limited force. It "
        "acts on the nearest state, which may be one of embedded points. In SOFA, LinearMovementProjectiveConstraint "
        "moves chosen nodes exactly and frees them at its last key time; RestShapeSpringsForceField, with "
        "external_rest_shape on points that such a constraint moves, ties them by springs, and "
        "AttachProjectiveConstraint rigidly; none of them chooses nodes during the run or limits the force.",
    .templates = kVec3Templates,
    .attributes = kGraspAttributes};

inline constexpr Attribute kProbeAttributes[] = {
    {.name = "value",
     .type = Type::kReals,
     .help = "A link to the numbers or vectors that are recorded, for example @forceps.force, @nodes.position or "
             "@material.plasticStrain."},
    {.name = "indices",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Entries of the value that count, for example nodes, or @tumour.hexahedronIndices; default: all."},
    {.name = "points",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Points of the body, where they are at the beginning. The value is one vector per node then, and the "
             "entries are its values at these points, interpolated in their hexahedra."},
    {.name = "component",
     .type = Type::kWord,
     .initial = "norm",
     .words = "x y z norm",
     .help = "Of vectors: which component, or their length. Without effect for numbers."},
    {.name = "statistic",
     .type = Type::kWord,
     .initial = "mean",
     .words = "mean sum min max",
     .help = "How several entries become one number. Mean and sum of vectors are vectors; min and max are those of the "
             "component."},
    {.name = "change",
     .type = Type::kBool,
     .initial = "false",
     .help = "The change since the beginning: of positions, the displacement."},
};
inline constexpr Description kProbe{
    .class_name = "Probe",
    .category = "Probe",
    .help =
        "Records a number after every step: a column of history.csv that has its name, a chart of the report, a "
        "line of the summary, and a column that `hexaplast fit` can compare. Of values per hexahedron, those of "
        "removed "
        "ones do not count; 0 where none is left. It changes nothing in the run.",
    .attributes = kProbeAttributes};

inline constexpr Attribute kRunSettingsAttributes[] = {
    {.name = "steps",
     .type = Type::kInteger,
     .range = {.min = 0, .max = 1e9},
     .help = "Number of time steps of a run, unless the command line gives one."},
    {.name = "outputEvery",
     .type = Type::kInteger,
     .initial = "25",
     .range = {.min = 1, .max = 1e9},
     .help = "Steps between two saved states."},
    {.name = "endSections",
     .type = Type::kWord,
     .initial = "auto",
     .words = "auto yes no",
     .help =
         "Whether a run records elongation and twist between the end sections of the longest axis of its body. "
         "auto: if there is one body without instruments, and what fixes, moves or loads its nodes acts on both end "
         "sections, and otherwise on whole cross sections alone."},
};
inline constexpr Description kRunSettings{.class_name = "RunSettings",
                                          .category = "Settings",
                                          .help = "How long a scene runs and how often its state is saved.",
                                          .attributes = kRunSettingsAttributes};

inline constexpr Attribute kAttributeChangeAttributes[] = {
    {.name = "component",
     .type = Type::kLink,
     .help = "The component that has the attribute. It stands behind this one in the scene."},
    {.name = "attribute",
     .type = Type::kText,
     .help = "Its name. The component must accept a new value during the run, as bodies accept those of their material "
             "and instruments those of their path."},
    {.name = "keyTimes",
     .type = Type::kReals,
     .unit = "s",
     .help = "Times of the changes, ascending. Each happens at the beginning of the first step from this time on."},
    {.name = "values",
     .type = Type::kText,
     .help = "The value from each key time on, as the attribute takes it, separated by semicolons. An empty one: as if "
             "the attribute were not given."},
};
inline constexpr Description kAttributeChange{
    .class_name = "AttributeChange",
    .category = "Settings",
    .help = "Changes an attribute of another component during the run, as the sliders of the live window do.",
    .attributes = kAttributeChangeAttributes};

}  // namespace hexaplast::attributes
