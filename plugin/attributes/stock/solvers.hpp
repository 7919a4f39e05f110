// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Time integration, equilibrium, and the linear systems in them. See stock.hpp.
namespace hexaplast::attributes {

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
    {.name = "vdamping",
     .type = Type::kReal,
     .initial = "0",
     .unit = "1/s",
     .range = kNotNegative,
     .help = "Velocities decay as exp(-vdamping dt) at the end of each step, after the positions."},
    {.name = "firstOrder",
     .type = Type::kBool,
     .initial = "false",
     .help = "Solves M dx/dt = f: the mass acts as a viscosity. Without damping."},
    {.name = "trapezoidalScheme",
     .type = Type::kBool,
     .initial = "false",
     .help = "Forces at the middle of the step, with half the numerical damping. As in SOFA it is of first order in "
             "time, and vibrations faster than 2 / dt (rad/s) grow, even with Rayleigh damping."},
    {.name = "linearSolver", .type = Type::kLink, .help = "Solver of the linear system; default: the nearest one."},
    ignored_attribute("solveConstraint", "Ignored here: there are no Lagrangian constraints."),
    ignored_attribute("threadSafeVisitor", "Ignored here."),
    ignored_attribute("computeResidual", "Ignored here."),
};
inline constexpr Description kEulerImplicitSolver{.class_name = "EulerImplicitSolver",
                                                  .category = "OdeSolver",
                                                  .help = "Linearised implicit Euler: one linear solve per time step.",
                                                  .attributes = kEulerImplicitAttributes};

inline constexpr Attribute kStaticAttributes[] = {
    {.name = "newtonSolver", .type = Type::kLink, .help = "Newton solver; default: the nearest one."},
    {.name = "linearSolver", .type = Type::kLink, .help = "Solver of the linear systems; default: the nearest one."},
    ignored_attribute("should_diverge_when_residual_is_growing", "Ignored here."),
};
inline constexpr Description kStaticSolver{
    .class_name = "StaticSolver",
    .category = "OdeSolver",
    .help = "Static equilibrium under the loads at the beginning of each time step, then one plastic step.",
    .attributes = kStaticAttributes};

inline constexpr Attribute kNewtonRaphsonAttributes[] = {
    {.name = "maxNbIterationsNewton",
     .type = Type::kInteger,
     .initial = "1",
     .range = {.min = 1, .max = 1e9},
     .help = "Largest number of iterations per step."},
    {.name = "relativeSuccessiveStoppingThreshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Stops when |r_k| / |r_k-1| <= this value. 0 switches a threshold off."},
    {.name = "relativeInitialStoppingThreshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Stops when |r_k| / |r_0| <= this value."},
    {.name = "absoluteResidualStoppingThreshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .unit = "N",
     .range = kNotNegative,
     .help = "Stops when |r_k| <= this value: lower it for small loads."},
    {.name = "relativeEstimateDifferenceThreshold",
     .type = Type::kReal,
     .initial = "0",
     .range = kNotNegative,
     .help = "Stops when |x_k - x_k-1| / |x_k-1| <= this value."},
    {.name = "absoluteEstimateDifferenceThreshold",
     .type = Type::kReal,
     .initial = "0",
     .unit = "m",
     .range = kNotNegative,
     .help = "Stops when |x_k - x_k-1| <= this value."},
    {.name = "maxNbIterationsLineSearch",
     .type = Type::kInteger,
     .initial = "1",
     .range = {.min = 1, .max = 1e9},
     .help = "Step lengths tried per iteration until |r| decreases."},
    {.name = "lineSearchCoefficient",
     .type = Type::kReal,
     .initial = "0.5",
     .range = {.min = 0, .max = 1, .exclusive_min = true, .exclusive_max = true},
     .help = "Factor of the step length for each further try."},
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
    ignored_attribute("residualGraph", "Ignored here."),
};
inline constexpr Description kNewtonRaphsonSolver{
    .class_name = "NewtonRaphsonSolver",
    .category = "NewtonRaphsonSolver",
    .help = "Stopping rules and line search of a StaticSolver. Norms are over all its bodies.",
    .attributes = kNewtonRaphsonAttributes};

inline constexpr Attribute kCGLinearSolverAttributes[] = {
    {.name = "iterations",
     .type = Type::kInteger,
     .initial = "25",
     .range = {.min = 1, .max = 1e9},
     .help = "Largest number of iterations."},
    {.name = "tolerance",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Stops when |r| / |b| <= this value. As in SOFA both are over all states: a heavy body hides the residual "
             "of a light one."},
    {.name = "threshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Stops when p.Ap <= this value; 0 switches it off. Tissue lies below the default: then nothing is "
             "solved, and velocities stay."},
    {.name = "warmStart",
     .type = Type::kBool,
     .initial = "false",
     .help = "Begins with the solution of the step before."},
    ignored_attribute("graph", "Ignored here."),
};
inline constexpr std::string_view kCGTemplates =
    "GraphScattered CompressedRowSparseMatrix CompressedRowSparseMatrixd CompressedRowSparseMatrixMat3x3 "
    "CompressedRowSparseMatrixMat3x3d";
inline constexpr Description kCGLinearSolver{.class_name = "CGLinearSolver",
                                             .category = "LinearSolver",
                                             .help = "Conjugate gradients without assembled matrix.",
                                             .templates = kCGTemplates,
                                             .attributes = kCGLinearSolverAttributes};

inline constexpr Attribute kSparseLDLAttributes[] = {
    ignored_attribute("precomputeSymbolicDecomposition", "Ignored here: it is kept as long as the pattern stays."),
    ignored_attribute("orderingMethod", "Ignored here: CHOLMOD chooses the order."),
    ignored_attribute("parallelInverseProduct", "Ignored here."),
    ignored_attribute("savingPrecision", "Ignored here."),
};
inline constexpr Description kSparseLDLSolver{
    .class_name = "SparseLDLSolver",
    .category = "LinearSolver",
    .help = "Direct sparse factorisation by CHOLMOD, of the matrix of the present step.",
    .templates = kMatrixTemplates,
    .attributes = kSparseLDLAttributes};

}  // namespace hexaplast::attributes
