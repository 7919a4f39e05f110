// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// SOFA's components as the embedded host knows them: names, defaults and meaning are SOFA's.
namespace hexaplast::attributes {

inline constexpr Attribute kNodeAttributes[] = {
    {.name = "dt",
     .type = Type::kReal,
     .initial = "0.01",
     .unit = "s",
     .range = kPositive,
     .help = "Time step. Only the root's counts."},
    {.name = "gravity",
     .type = Type::kVector3,
     .initial = "0 -9.81 0",
     .unit = "m/s^2",
     .help = "Acceleration of every mass. Only the root's counts."},
    {.name = "animate", .type = Type::kBool, .initial = "false", .access = Access::kIgnored, .help = "Ignored here."},
    {.name = "bbox", .type = Type::kReals, .access = Access::kIgnored, .help = "Visual: ignored here."},
};
inline constexpr Description kNode{.class_name = "Node",
                                   .category = "Node",
                                   .help = "Holds components and further nodes.",
                                   .attributes = kNodeAttributes};

inline constexpr Attribute kRequiredPluginAttributes[] = {
    {.name = "pluginName",
     .type = Type::kText,
     .help = "Names of plugins, separated by blanks; `name` where it is not given."},
};
inline constexpr Description kRequiredPlugin{
    .class_name = "RequiredPlugin",
    .category = "Settings",
    .help = "Loads plugins by name. Names that begin with Sofa. are SOFA's own modules and need no loading here.",
    .attributes = kRequiredPluginAttributes};

inline constexpr Attribute kVisualStyleAttributes[] = {
    {.name = "displayFlags", .type = Type::kText, .access = Access::kIgnored, .help = "Visual: ignored here."},
};
inline constexpr Description kVisualStyle{.class_name = "VisualStyle",
                                          .category = "Visual",
                                          .help = "Visual: ignored here.",
                                          .attributes = kVisualStyleAttributes};

inline constexpr Description kDefaultAnimationLoop{
    .class_name = "DefaultAnimationLoop",
    .category = "AnimationLoop",
    .help = "The order of events of a time step. A root without animation loop gets this one."};

inline constexpr Attribute kEulerImplicitAttributes[] = {
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Stiffness-proportional damping."},
    {.name = "rayleighMass",
     .type = Type::kReal,
     .initial = "0",
     .unit = "1/s",
     .range = kNotNegative,
     .help = "Mass-proportional damping."},
    {.name = "linearSolver",
     .type = Type::kLink,
     .help =
         "Solver of the linear system; the first one of the node (or of the nearest one above) where it is not given."},
};
inline constexpr Description kEulerImplicitSolver{.class_name = "EulerImplicitSolver",
                                                  .category = "OdeSolver",
                                                  .help = "Linearised implicit Euler: one linear solve per time step.",
                                                  .attributes = kEulerImplicitAttributes};

inline constexpr Attribute kStaticAttributes[] = {
    {.name = "newtonSolver",
     .type = Type::kLink,
     .help =
         "How equilibrium is looked for; the NewtonRaphsonSolver of the node (or of the nearest one above) where it "
         "is not given."},
    {.name = "linearSolver",
     .type = Type::kLink,
     .help = "Solver of the linear systems; the first one of the node (or of the nearest one above) where it is not "
             "given."},
};
inline constexpr Description kStaticSolver{
    .class_name = "StaticSolver",
    .category = "OdeSolver",
    .help =
        "Static equilibrium under the loads at the beginning of each time step; masses count through gravity alone. "
        "What flows plastically does so after equilibrium, once per step.",
    .attributes = kStaticAttributes};

inline constexpr Attribute kNewtonRaphsonAttributes[] = {
    {.name = "maxNbIterationsNewton",
     .type = Type::kInteger,
     .initial = "1",
     .range = {.least = 1, .most = 1e9},
     .help = "Largest number of iterations per step."},
    {.name = "relativeSuccessiveStoppingThreshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Ends when |r_k| / |r_k-1| is not greater. 0 switches a threshold off."},
    {.name = "relativeInitialStoppingThreshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Ends when |r_k| / |r_0| is not greater."},
    {.name = "absoluteResidualStoppingThreshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .unit = "N",
     .range = kNotNegative,
     .help = "Ends when |r_k| is not greater: lower it for small loads."},
    {.name = "relativeEstimateDifferenceThreshold",
     .type = Type::kReal,
     .initial = "0",
     .range = kNotNegative,
     .help = "Ends when |x_k - x_k-1| / |x_k-1| is not greater."},
    {.name = "absoluteEstimateDifferenceThreshold",
     .type = Type::kReal,
     .initial = "0",
     .unit = "m",
     .range = kNotNegative,
     .help = "Ends when |x_k - x_k-1| is not greater."},
    {.name = "maxNbIterationsLineSearch",
     .type = Type::kInteger,
     .initial = "1",
     .range = {.least = 1, .most = 1e9},
     .help = "Step lengths tried per iteration until |r| decreases."},
    {.name = "lineSearchCoefficient",
     .type = Type::kReal,
     .initial = "0.5",
     .range = {.least = 0, .most = 1, .without_least = true, .without_most = true},
     .help = "By which each further try is shorter."},
    {.name = "updateStateWhenDiverged",
     .type = Type::kBool,
     .initial = "true",
     .help = "Keeps the last iterate when no threshold was met."},
    {.name = "warnWhenLineSearchFails",
     .type = Type::kBool,
     .initial = "true",
     .access = Access::kIgnored,
     .help = "Ignored here: steps without equilibrium are always counted and reported."},
    {.name = "warnWhenDiverge",
     .type = Type::kBool,
     .initial = "true",
     .access = Access::kIgnored,
     .help = "Ignored here: steps without equilibrium are always counted and reported."},
};
inline constexpr Description kNewtonRaphsonSolver{.class_name = "NewtonRaphsonSolver",
                                                  .category = "NewtonRaphsonSolver",
                                                  .help = "Stopping rules and line search of a StaticSolver.",
                                                  .attributes = kNewtonRaphsonAttributes};

inline constexpr Attribute kCGLinearSolverAttributes[] = {
    {.name = "iterations",
     .type = Type::kInteger,
     .initial = "25",
     .range = {.least = 1, .most = 1e9},
     .help = "Largest number of iterations."},
    {.name = "tolerance",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Ends when |r| / |b| is not greater."},
    {.name = "threshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Ends when p.Ap is not greater: an absolute bound, so lower it for small loads and small masses."},
    {.name = "warmStart",
     .type = Type::kBool,
     .initial = "false",
     .help = "Begins with the solution of the step before."},
};
inline constexpr Description kCGLinearSolver{
    .class_name = "CGLinearSolver",
    .category = "LinearSolver",
    .help = "Conjugate gradients without assembled matrix.",
    .templates =
        "GraphScattered CompressedRowSparseMatrix CompressedRowSparseMatrixd CompressedRowSparseMatrixMat3x3 "
        "CompressedRowSparseMatrixMat3x3d",
    .attributes = kCGLinearSolverAttributes};

inline constexpr Description kSparseLDLSolver{.class_name = "SparseLDLSolver",
                                              .category = "LinearSolver",
                                              .help = "Direct sparse factorisation, served by CHOLMOD.",
                                              .templates = kMatrixTemplates};

inline constexpr Attribute kMechanicalObjectAttributes[] = {
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kState,
     .help = "Nodes. Those of the topology where at most one is given."},
    {.name = "velocity",
     .type = Type::kVectors3,
     .unit = "m/s",
     .access = Access::kState,
     .help = "At rest where not given."},
    {.name = "rest_position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kState,
     .help = "Undeformed nodes; the transformed positions where not given."},
    {.name = "externalForce", .type = Type::kVectors3, .unit = "N", .help = "Constant nodal forces, one per node."},
    {.name = "scale3d", .type = Type::kVector3, .initial = "1 1 1", .help = "Applied first to the positions."},
    {.name = "rotation",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "deg",
     .help = "About x, then y, then z; applied second."},
    {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
    {.name = "topology",
     .type = Type::kLink,
     .help = "Source of the nodes; the topology of the node (or of the nearest one above) where it is not given."},
    {.name = "showObject",
     .type = Type::kBool,
     .initial = "false",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
    {.name = "showObjectScale",
     .type = Type::kReal,
     .initial = "0.1",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
};
inline constexpr Description kMechanicalObject{.class_name = "MechanicalObject",
                                               .category = "MechanicalState",
                                               .help = "Positions and velocities of the nodes.",
                                               .templates = kVec3Templates,
                                               .attributes = kMechanicalObjectAttributes};

inline constexpr Attribute kRegularGridTopologyAttributes[] = {
    {.name = "n",
     .type = Type::kIntegers,
     .initial = "2 2 2",
     .range = {.least = 2, .most = 2147483646},
     .help = "Nodes (not cells) along x, y, z."},
    {.name = "min", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Lowest corner."},
    {.name = "max", .type = Type::kVector3, .initial = "1 1 1", .unit = "m", .help = "Highest corner."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .aliases = "points",
     .access = Access::kOutput,
     .help = "Nodes: i + nx (j + ny k)."},
    {.name = "hexahedra",
     .type = Type::kHexahedra,
     .aliases = "hexas",
     .access = Access::kOutput,
     .help = "Cells, x fastest."},
};
inline constexpr Description kRegularGridTopology{.class_name = "RegularGridTopology",
                                                  .category = "Topology",
                                                  .help = "A box cut into equal cells.",
                                                  .attributes = kRegularGridTopologyAttributes};

inline constexpr Attribute kMassRayleigh{
    .name = "rayleighMass",
    .type = Type::kReal,
    .initial = "0",
    .unit = "1/s",
    .range = kNotNegative,
    .help = "Damping by this mass in the system matrix alone, besides the solver's own."};

inline constexpr Attribute kUniformMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Shared equally by all nodes."},
    {.name = "vertexMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help = "Of each node, unless totalMass is given."},
    kMassRayleigh,
};
inline constexpr Description kUniformMass{.class_name = "UniformMass",
                                          .category = "Mass",
                                          .help = "The same mass at every node.",
                                          .templates = "Vec3 Vec3d Vec3,double Vec3d,double",
                                          .attributes = kUniformMassAttributes};

inline constexpr Attribute kDiagonalMassAttributes[] = {
    {.name = "totalMass",
     .type = Type::kReal,
     .unit = "kg",
     .range = kPositive,
     .help =
         "Of the whole body, spread by volume. Counts before massDensity, which counts before vertexMass; 1 kg where "
         "none is given."},
    {.name = "massDensity",
     .type = Type::kReal,
     .unit = "kg/m^3",
     .range = kPositive,
     .help = "Mass per volume at rest."},
    {.name = "vertexMass", .type = Type::kReals, .unit = "kg", .range = kNotNegative, .help = "One value per node."},
    kMassRayleigh,
    {.name = "topology",
     .type = Type::kLink,
     .help = "The hexahedra; the topology of the node (or of the nearest one above) where it is not given."},
};
inline constexpr Description kDiagonalMass{.class_name = "DiagonalMass",
                                           .category = "Mass",
                                           .help = "Each hexahedron gives an eighth of its mass to each of its nodes.",
                                           .templates = "Vec3 Vec3d Vec3,double Vec3d,double",
                                           .attributes = kDiagonalMassAttributes};

inline constexpr Attribute kBoxROIAttributes[] = {
    {.name = "box",
     .type = Type::kBoxes,
     .initial = "0 0 0 1 1 1",
     .unit = "m",
     .help = "Two opposite corners of each box, in any order. Points on the border are inside."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Points to look at; the rest positions of the node's mechanical state where not given."},
    {.name = "strict",
     .type = Type::kBool,
     .initial = "true",
     .help = "A hexahedron is inside when all its nodes are; otherwise when its centre is."},
    {.name = "drawBoxes",
     .type = Type::kBool,
     .initial = "false",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
    {.name = "indices", .type = Type::kIntegers, .access = Access::kOutput, .help = "Points inside, ascending."},
    {.name = "indicesOut", .type = Type::kIntegers, .access = Access::kOutput, .help = "Points outside, ascending."},
    {.name = "hexahedronIndices",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "Hexahedra inside, ascending."},
    {.name = "pointsInROI",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Their positions."},
};
inline constexpr Description kBoxROI{.class_name = "BoxROI",
                                     .category = "Engine",
                                     .help = "Finds what lies in boxes.",
                                     .templates = kVec3Templates,
                                     .attributes = kBoxROIAttributes};

inline constexpr Attribute kFixedProjectiveConstraintAttributes[] = {
    {.name = "indices",
     .type = Type::kIntegers,
     .initial = "0",
     .range = kIndex,
     .help = "Nodes that receive no acceleration."},
    {.name = "fixAll", .type = Type::kBool, .initial = "false", .help = "Fixes every node."},
    {.name = "showObject",
     .type = Type::kBool,
     .initial = "true",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
    {.name = "drawSize",
     .type = Type::kReal,
     .initial = "0",
     .access = Access::kIgnored,
     .help = "Visual: ignored here."},
};
inline constexpr Description kFixedProjectiveConstraint{
    .class_name = "FixedProjectiveConstraint",
    .category = "ProjectiveConstraint",
    .help = "Holds nodes: their acceleration is zero, so that a velocity they begin with persists.",
    .templates = kVec3Templates,
    .attributes = kFixedProjectiveConstraintAttributes};

inline constexpr Attribute kConstantForceFieldAttributes[] = {
    {.name = "indices", .type = Type::kIntegers, .range = kIndex, .help = "Nodes; all of them where not given."},
    {.name = "forces",
     .type = Type::kVectors3,
     .unit = "N",
     .help = "One for every node, or one per index. Counts before totalForce; one of the two is needed."},
    {.name = "totalForce",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "N",
     .help = "Shared equally by the nodes."},
};
inline constexpr Description kConstantForceField{.class_name = "ConstantForceField",
                                                 .category = "ForceField",
                                                 .help = "Forces that never change.",
                                                 .templates = kVec3Templates,
                                                 .attributes = kConstantForceFieldAttributes};

inline constexpr Attribute kLinearForceFieldAttributes[] = {
    {.name = "points", .type = Type::kIntegers, .range = kIndex, .help = "Nodes; each receives the whole force."},
    {.name = "times", .type = Type::kReals, .unit = "s", .help = "Key times, ascending."},
    {.name = "forces",
     .type = Type::kVectors3,
     .unit = "N",
     .help =
         "Force on each node at each key time: none before the first time, linear in between, the last one from the "
         "last time on. Evaluated at the beginning of a step."},
    {.name = "force",
     .type = Type::kReal,
     .initial = "1",
     .help = "Factor of the forces, except from the last time on."},
};
inline constexpr Description kLinearForceField{.class_name = "LinearForceField",
                                               .category = "ForceField",
                                               .help = "Forces that follow a history.",
                                               .templates = kVec3Templates,
                                               .attributes = kLinearForceFieldAttributes};

}  // namespace hexaplast::attributes
