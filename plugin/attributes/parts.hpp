// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/path.hpp"

/// Our own components but bodies and shapes, the same in every host.
namespace hexaplast::attributes {

inline constexpr Table kMultigridCGLinearSolver{
    Category{"LinearSolver"}("MultigridCGLinearSolver",
                             "Preconditioned conjugate gradients with a relative tolerance."),
    one_of(
        "preconditioner", {.initial = "auto", .words = "auto multigrid diagonal"},
        "multigrid: a V-cycle on coarser meshes, for hexahedra that form a lattice (grids, tubes, shells, cages); "
        "elsewhere the diagonal is used. diagonal: cheaper if a pressure wave crosses less than about four hexahedra "
        "in a time step. auto: the cheaper one."),
    real("tolerance", {.initial = "0.01", .range = {.min = 0, .max = 1, .exclusive_min = true}},
         "Stops when |r| / |b| <= this value for each independent state; |b| is its load, or the force of contact and "
         "springs on it if that is larger."),
    integer("iterations", {.initial = "500", .range = {.min = 1, .max = 1000000000}}, "Largest number of iterations."),
};

inline constexpr Table kTangentialForceField{
    force_field("TangentialForceField",
                "Forces around an axis that turn with the body: along axis x (p - centre), p being the mean position "
                "of the group, divided equally among its nodes."),
    indices("indices", "Nodes, group after group."),
    integer("groupSize", {.initial = "1", .range = {.min = 1, .max = 2147483646}},
            "Consecutive indices that form a group: 1 for nodes, 2 for the centres of edges."),
    vector3("axis", {.initial = "0 0 1"}, "Direction of the axis; its length is irrelevant."),
    vector3("centre", {.initial = "0 0 0", .unit = "m"}, "A point on the axis."),
    reals("times", {.unit = "s"}, "Key times, ascending."),
    reals("forces", {.unit = "N"},
          "Force on each group at each key time: none before the first time, linear in between, constant after the "
          "last. That at the beginning of a step counts."),
};

inline constexpr Table kGraspForceField{
    force_field("GraspForceField",
                "An instrument that grasps the nodes around it, moves along a path and releases them, with a limited "
                "force. It acts on the nearest state, which may be one of embedded points."),
    reals("keyTimes", {.unit = "s", .group = "Path"}, "Key times of the tool's path, ascending."),
    vectors3("positions", {.unit = "m", .group = "Path"},
             "Position of the tool at each key time, linear in between; constant before the first time and after the "
             "last. That at the beginning of a step counts."),
    real("graspTime", {.initial = "0", .unit = "s", .range = kNotNegative, .group = "Path"},
         "The grip closes in the first step from this time on."),
    real("releaseTime", {.unit = "s", .range = kPositive, .group = "Path"},
         "The grip opens in the first step from this time on. Default: never."),
    real("radius", {.unit = "m", .range = kPositive, .group = "Grip"},
         "The grip takes the nodes within this distance when it closes; a warning appears if there are none."),
    indices("indices", {.group = "Grip"}, "Nodes that can be held; default: all."),
    real("stiffness", {.initial = "1000", .unit = "N/m", .range = kPositive, .group = "Grip"},
         "Of the whole grip. Each of n held nodes has a spring of 1/n of it to its place at closing, relative to the "
         "tool."),
    real("maxForce", {.unit = "N", .range = kPositive, .group = "Grip"},
         "Limit of the force of the whole grip; each spring pulls with at most 1/n of it. Default: no limit."),
    real("damping", {.initial = "0", .unit = "N s/m", .range = kNotNegative, .group = "Grip"},
         "Of the whole grip: a dashpot of 1/n of it beside each spring, against the velocity relative to the tool. "
         "maxForce does not limit it."),
    kForceRayleigh,
    output(integers("grasped", "Nodes that the grip holds now.")),
    output(vector3("force", {.unit = "N"}, "Force of the tool on the body at the beginning of the last step.")),
    output(vector3("torque", {.unit = "N m"}, "Moment of that force about the tool.")),
};

inline constexpr Table kBladeController{
    Category{"Controller"}(
        "BladeController",
        "A blade that moves along a path and cuts a body: two hexahedra separate where its edge passes between "
        "their centres, at the end of the step. It presses on nothing."),
    link("body", "The body that it cuts, or its node. Default: the nearest one."),
    vectors3("points", {.unit = "m", .group = "Blade"},
             "Its edge in the frame of the blade: at least two points, with a straight line from each to the next."),
    kPathAttributes,
    boolean("active", {.initial = "true", .group = "Blade"}, "false: it opens nothing."),
};
inline constexpr Table kBladeInSofa{kBladeController, kBladeController.rows, kFrameAttributes};

inline constexpr Table kProbe{
    Category{"Probe"}(
        "Probe",
        "Records a number after every step: the column probe_NAME of history.csv, a chart of the report, a line of the "
        "summary. Removed hexahedra do not count; 0 where none is left."),
    reals("value", "A link to numbers or vectors: @forceps.force, @nodes.position, @material.plasticStrain."),
    indices("indices", "Entries of the value that count: nodes, or @tumour.hexahedronIndices; default: all."),
    vectors3("points", {.unit = "m"},
             "Initial positions of points of the body: the entries are the values there, interpolated from one vector "
             "per node."),
    one_of("component", {.initial = "norm", .words = "x y z norm"}, "Of vectors: a component, or the length."),
    one_of("statistic", {.initial = "mean", .words = "mean sum min max"},
           "Makes one number of several entries: mean and sum of vectors, then the component; min and max of the "
           "component."),
    boolean("change", {.initial = "false"}, "The change since the beginning: of positions, the displacement."),
};

inline constexpr Table kRunSettings{
    Category{"Settings"}("RunSettings", "How long a scene runs and how often its state is saved."),
    integer("steps", {.range = {.min = 0, .max = 1e9}}, "Time steps of a run, unless the command line gives them."),
    integer("outputEvery", {.initial = "25", .range = {.min = 1, .max = 1e9}}, "Steps between two saved states."),
    one_of(
        "endSections", {.initial = "auto", .words = "auto yes no"},
        "Whether a run records elongation and twist between the end sections of its body. auto: if what fixes, moves "
        "or loads its one body acts on both end sections, and otherwise on whole cross sections, without instruments."),
};

inline constexpr Table kAttributeChange{
    Category{"Settings"}("AttributeChange", "Changes an attribute of another component during the run."),
    link("component", "The component that has the attribute, behind this one in the scene."),
    free_text("attribute",
              "Its name. It must be one that may change during a run, as those of materials and of paths."),
    reals("keyTimes", {.unit = "s"}, "Times of the changes, ascending: each in the first step from this time on."),
    free_text(
        "values",
        "The value from each key time on, separated by semicolons. An empty one: as if the attribute were not given."),
};

}  // namespace hexaplast::attributes
