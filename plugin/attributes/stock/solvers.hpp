// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Time integration, equilibrium, and the linear systems in them. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr std::array kEulerImplicitAttributes = {
    real("rayleighStiffness", {.initial = "0", .unit = "s", .range = kNotNegative}, "Stiffness-proportional damping."),
    real("rayleighMass", {.initial = "0", .unit = "1/s", .range = kNotNegative}, "Mass-proportional damping."),
    real("vdamping", {.initial = "0", .unit = "1/s", .range = kNotNegative},
         "Velocities decay as exp(-vdamping dt) at the end of each step, after the positions."),
    boolean("firstOrder", {.initial = "false"}, "Solves M dx/dt = f: the mass acts as a viscosity. Without damping."),
    boolean("trapezoidalScheme", {.initial = "false"},
            "Forces at the middle of the step, with half the numerical damping. As in SOFA it is of first order in "
            "time, and vibrations faster than 2 / dt (rad/s) grow, even with Rayleigh damping."),
    link("linearSolver", "Solver of the linear system; default: the nearest one."),
    ignored_attribute("solveConstraint", "Ignored here: there are no Lagrangian constraints."),
    ignored_attribute("threadSafeVisitor", "Ignored here."),
    ignored_attribute("computeResidual", "Ignored here."),
};
inline constexpr Description kEulerImplicitSolver = ode_solver(
    "EulerImplicitSolver", "Linearised implicit Euler: one linear solve per time step.", kEulerImplicitAttributes);

inline constexpr std::array kStaticAttributes = {
    link("newtonSolver", "Newton solver; default: the nearest one."),
    link("linearSolver", "Solver of the linear systems; default: the nearest one."),
    ignored_attribute("should_diverge_when_residual_is_growing", "Ignored here."),
};
inline constexpr Description kStaticSolver = ode_solver(
    "StaticSolver", "Static equilibrium under the loads at the beginning of each time step, then one plastic step.",
    kStaticAttributes);

inline constexpr std::array kNewtonRaphsonAttributes = {
    integer("maxNbIterationsNewton", {.initial = "1", .range = {.min = 1, .max = 1e9}},
            "Largest number of iterations per step."),
    real("relativeSuccessiveStoppingThreshold", {.initial = "1e-5", .range = kNotNegative},
         "Stops when |r_k| / |r_k-1| <= this value. 0 switches a threshold off."),
    real("relativeInitialStoppingThreshold", {.initial = "1e-5", .range = kNotNegative},
         "Stops when |r_k| / |r_0| <= this value."),
    real("absoluteResidualStoppingThreshold", {.initial = "1e-5", .unit = "N", .range = kNotNegative},
         "Stops when |r_k| <= this value: lower it for small loads."),
    real("relativeEstimateDifferenceThreshold", {.initial = "0", .range = kNotNegative},
         "Stops when |x_k - x_k-1| / |x_k-1| <= this value."),
    real("absoluteEstimateDifferenceThreshold", {.initial = "0", .unit = "m", .range = kNotNegative},
         "Stops when |x_k - x_k-1| <= this value."),
    integer("maxNbIterationsLineSearch", {.initial = "1", .range = {.min = 1, .max = 1e9}},
            "Step lengths tried per iteration until |r| decreases."),
    real("lineSearchCoefficient",
         {.initial = "0.5", .range = {.min = 0, .max = 1, .exclusive_min = true, .exclusive_max = true}},
         "Factor of the step length for each further try."),
    boolean("updateStateWhenDiverged", {.initial = "true"}, "Keeps the last iterate when no threshold was met."),
    boolean("warnWhenLineSearchFails", {.initial = "true", .access = Access::kIgnored},
            "Ignored here: steps without equilibrium are always counted and reported."),
    boolean("warnWhenDiverge", {.initial = "true", .access = Access::kIgnored},
            "Ignored here: steps without equilibrium are always counted and reported."),
    ignored_attribute("residualGraph", "Ignored here."),
};
inline constexpr Description kNewtonRaphsonSolver{
    .class_name = "NewtonRaphsonSolver",
    .category = "NewtonRaphsonSolver",
    .help = "Stopping rules and line search of a StaticSolver. Norms are over all its bodies.",
    .attributes = kNewtonRaphsonAttributes};

inline constexpr std::array kCGLinearSolverAttributes = {
    integer("iterations", {.initial = "25", .range = {.min = 1, .max = 1e9}}, "Largest number of iterations."),
    real("tolerance", {.initial = "1e-5", .range = kNotNegative},
         "Stops when |r| / |b| <= this value. As in SOFA both are over all states: a heavy body hides the residual of "
         "a light one."),
    real("threshold", {.initial = "1e-5", .range = kNotNegative},
         "Stops when p.Ap <= this value; 0 switches it off. Tissue lies below the default: then nothing is solved, and "
         "velocities stay."),
    boolean("warmStart", {.initial = "false"}, "Begins with the solution of the step before."),
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

inline constexpr std::array kSparseLDLAttributes = {
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
