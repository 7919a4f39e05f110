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
     .help = "multigrid: a V-cycle on coarser meshes, for hexahedra that form a lattice (grids, tubes, shells, cages); "
             "elsewhere the diagonal is used. diagonal: cheaper if a pressure wave crosses less than about four "
             "hexahedra in a time step. auto: the cheaper one."},
    {.name = "tolerance",
     .type = Type::kReal,
     .initial = "0.01",
     .range = {.min = 0, .max = 1, .exclusive_min = true},
     .help = "Stops when |r| / |b| <= this value for each independent state; |b| is its load, or the force of contact "
             "and springs on it if that is larger."},
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
     .help = "Force on each group at each key time: none before the first time, linear in between, constant after the "
             "last. That at the beginning of a step counts."},
};
inline constexpr Description kTangentialForceField{
    .class_name = "TangentialForceField",
    .category = "ForceField",
    .help =
        "Forces around an axis that turn with the body: along axis x (p - centre), p being the mean position of the "
        "group, divided equally among its nodes.",
    .templates = kVec3Templates,
    .attributes = kTangentialForceAttributes};

inline constexpr Attribute kGraspAttributes[] = {
    {.name = "keyTimes",
     .type = Type::kReals,
     .unit = "s",
     .help = "Key times of the tool's path, ascending.",
     .group = "Path"},
    {.name = "positions",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Position of the tool at each key time, linear in between; constant before the first time and after the "
             "last. That at the beginning of a step counts.",
     .group = "Path"},
    {.name = "graspTime",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "The grip closes in the first step from this time on.",
     .group = "Path"},
    {.name = "releaseTime",
     .type = Type::kReal,
     .unit = "s",
     .range = kPositive,
     .help = "The grip opens in the first step from this time on. Default: never.",
     .group = "Path"},
    {.name = "radius",
     .type = Type::kReal,
     .unit = "m",
     .range = kPositive,
     .help = "The grip takes the nodes within this distance when it closes; a warning appears if there are none.",
     .group = "Grip"},
    {.name = "indices",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Nodes that can be held; default: all.",
     .group = "Grip"},
    {.name = "stiffness",
     .type = Type::kReal,
     .initial = "1000",
     .unit = "N/m",
     .range = kPositive,
     .help = "Of the whole grip. Each of n held nodes has a spring of 1/n of it to its place at closing, relative to "
             "the tool.",
     .group = "Grip"},
    {.name = "maxForce",
     .type = Type::kReal,
     .unit = "N",
     .range = kPositive,
     .help = "Limit of the force of the whole grip; each spring pulls with at most 1/n of it. Default: no limit.",
     .group = "Grip"},
    {.name = "damping",
     .type = Type::kReal,
     .initial = "0",
     .unit = "N s/m",
     .range = kNotNegative,
     .help = "Of the whole grip: a dashpot of 1/n of it beside each spring, against the velocity relative to the tool. "
             "maxForce does not limit it.",
     .group = "Grip"},
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
     .help = "Moment of that force about the tool."},
};
inline constexpr Description kGraspForceField{
    .class_name = "GraspForceField",
    .category = "ForceField",
    .help =
        "An instrument that grasps the nodes around it, moves along a path and releases them, with a limited force. It "
        "acts on the nearest state, which may be one of embedded points.",
    .templates = kVec3Templates,
    .attributes = kGraspAttributes};

inline constexpr Attribute kProbeAttributes[] = {
    {.name = "value",
     .type = Type::kReals,
     .help = "A link to numbers or vectors: @forceps.force, @nodes.position, @material.plasticStrain."},
    {.name = "indices",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Entries of the value that count: nodes, or @tumour.hexahedronIndices; default: all."},
    {.name = "points",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Initial positions of points of the body: the entries are the values there, interpolated from one vector "
             "per node."},
    {.name = "component",
     .type = Type::kWord,
     .initial = "norm",
     .words = "x y z norm",
     .help = "Of vectors: a component, or the length."},
    {.name = "statistic",
     .type = Type::kWord,
     .initial = "mean",
     .words = "mean sum min max",
     .help = "Makes one number of several entries: mean and sum of vectors, then the component; min and max of the "
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
        "Records a number after every step: the column probe_NAME of history.csv, a chart of the report, a line of the "
        "summary. Removed hexahedra do not count; 0 where none is left.",
    .attributes = kProbeAttributes};

inline constexpr Attribute kRunSettingsAttributes[] = {
    {.name = "steps",
     .type = Type::kInteger,
     .range = {.min = 0, .max = 1e9},
     .help = "Time steps of a run, unless the command line gives them."},
    {.name = "outputEvery",
     .type = Type::kInteger,
     .initial = "25",
     .range = {.min = 1, .max = 1e9},
     .help = "Steps between two saved states."},
    {.name = "endSections",
     .type = Type::kWord,
     .initial = "auto",
     .words = "auto yes no",
     .help = "Whether a run records elongation and twist between the end sections of its body. auto: if what fixes, "
             "moves or loads its one body acts on both end sections, and otherwise on whole cross sections, without "
             "instruments."},
};
inline constexpr Description kRunSettings{.class_name = "RunSettings",
                                          .category = "Settings",
                                          .help = "How long a scene runs and how often its state is saved.",
                                          .attributes = kRunSettingsAttributes};

inline constexpr Attribute kAttributeChangeAttributes[] = {
    {.name = "component",
     .type = Type::kLink,
     .help = "The component that has the attribute, behind this one in the scene."},
    {.name = "attribute",
     .type = Type::kText,
     .help = "Its name. It must be one that may change during a run, as those of materials and of paths."},
    {.name = "keyTimes",
     .type = Type::kReals,
     .unit = "s",
     .help = "Times of the changes, ascending: each in the first step from this time on."},
    {.name = "values",
     .type = Type::kText,
     .help =
         "The value from each key time on, separated by semicolons. An empty one: as if the attribute were not given."},
};
inline constexpr Description kAttributeChange{.class_name = "AttributeChange",
                                              .category = "Settings",
                                              .help = "Changes an attribute of another component during the run.",
                                              .attributes = kAttributeChangeAttributes};

}  // namespace hexaplast::attributes
