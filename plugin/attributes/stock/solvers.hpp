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
     .help = "Velocities decay as exp(-vdamping dt) at the end of each step, when positions have moved already."},
    {.name = "firstOrder",
     .type = Type::kBool,
     .initial = "false",
     .help = "Solves M dx/dt = f: no inertia, the mass acts as a viscosity. Without damping."},
    {.name = "trapezoidalScheme",
     .type = Type::kBool,
     .initial = "false",
     .help =
         "Forces at the middle of the step instead of its end, with half the numerical damping. As in SOFA positions "
         "move by the velocity at the end: first order in time, and vibrations faster than 2 / dt (rad/s) grow from "
         "step to step, Rayleigh damping or not."},
    {.name = "linearSolver",
     .type = Type::kLink,
     .help = "Solver of the linear system; default: the first one of the node, or of the nearest one above."},
    ignored_attribute("solveConstraint", "Ignored here: there are no Lagrangian constraints."),
    ignored_attribute("threadSafeVisitor", "Ignored here."),
    ignored_attribute("computeResidual", "Ignored here."),
};
inline constexpr Description kEulerImplicitSolver{.class_name = "EulerImplicitSolver",
                                                  .category = "OdeSolver",
                                                  .help = "Linearised implicit Euler: one linear solve per time step.",
                                                  .attributes = kEulerImplicitAttributes};

inline constexpr Attribute kStaticAttributes[] = {
    {.name = "newtonSolver",
     .type = Type::kLink,
     .help = "Newton solver; default: the NewtonRaphsonSolver of the node, or of the nearest one above."},
    {.name = "linearSolver",
     .type = Type::kLink,
     .help = "Solver of the linear systems; default: the first one of the node, or of the nearest one above."},
    {.name = "newton_iterations",
     .type = Type::kInteger,
     .range = {.min = 1, .max = 1e9},
     .help = "Deprecated: NewtonRaphsonSolver.maxNbIterationsNewton."},
    {.name = "absolute_residual_tolerance_threshold",
     .type = Type::kReal,
     .unit = "N",
     .range = kNotNegative,
     .help = "Deprecated: NewtonRaphsonSolver.absoluteResidualStoppingThreshold."},
    {.name = "relative_residual_tolerance_threshold",
     .type = Type::kReal,
     .range = kNotNegative,
     .help = "Deprecated: NewtonRaphsonSolver.relativeInitialStoppingThreshold."},
    {.name = "absolute_correction_tolerance_threshold",
     .type = Type::kReal,
     .unit = "m",
     .range = kNotNegative,
     .help = "Deprecated: NewtonRaphsonSolver.absoluteEstimateDifferenceThreshold."},
    {.name = "relative_correction_tolerance_threshold",
     .type = Type::kReal,
     .range = kNotNegative,
     .help = "Deprecated: NewtonRaphsonSolver.relativeEstimateDifferenceThreshold."},
    ignored_attribute("should_diverge_when_residual_is_growing", "Ignored here."),
};
inline constexpr Description kStaticSolver{
    .class_name = "StaticSolver",
    .category = "OdeSolver",
    .help =
        "Static equilibrium under the loads at the beginning of each time step; masses act only through gravity. "
        "Plastic flow is computed once per step, after equilibrium.",
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
    .help = "Stopping rules and line search of a StaticSolver. Norms are those of all its bodies together.",
    .attributes = kNewtonRaphsonAttributes};

inline constexpr Attribute kLinearSystem{
    .name = "linearSystem",
    .type = Type::kLink,
    .help = "A component of SOFA that assembles the matrix: only whole matrices here, which are the solver's own."};

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
     .help = "Stops when |r| / |b| <= this value; as in SOFA, |r| and |b| are over all states together: a heavy body "
             "hides what is left of a light one (MultigridCGLinearSolver looks at each)."},
    {.name = "threshold",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Stops when p.Ap <= this value. The bound is absolute, and tissue lies below the default: nothing is "
             "solved then, and velocities stay. 0 switches it off."},
    {.name = "warmStart",
     .type = Type::kBool,
     .initial = "false",
     .help = "Begins with the solution of the step before."},
    kLinearSystem,
    ignored_attribute("graph", "Ignored here."),
};
inline constexpr std::string_view kIterativeTemplates =
    "GraphScattered CompressedRowSparseMatrix CompressedRowSparseMatrixd CompressedRowSparseMatrixMat3x3 "
    "CompressedRowSparseMatrixMat3x3d";
inline constexpr Description kCGLinearSolver{.class_name = "CGLinearSolver",
                                             .category = "LinearSolver",
                                             .help = "Conjugate gradients without assembled matrix.",
                                             .templates = kIterativeTemplates,
                                             .attributes = kCGLinearSolverAttributes};

inline constexpr Description kParallelCGLinearSolver{
    .class_name = "ParallelCGLinearSolver",
    .category = "LinearSolver",
    .help = "The same as CGLinearSolver, which uses all threads here as well.",
    .templates =
        "ParallelCompressedRowSparseMatrix ParallelCompressedRowSparseMatrixd "
        "ParallelCompressedRowSparseMatrixMat3x3 ParallelCompressedRowSparseMatrixMat3x3d",
    .attributes = kCGLinearSolverAttributes};

inline constexpr Attribute kMinResLinearSolverAttributes[] = {
    {.name = "iterations",
     .type = Type::kInteger,
     .initial = "25",
     .range = {.min = 1, .max = 1e9},
     .help = "Largest number of iterations."},
    {.name = "tolerance",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Stops when |r| / (|A| |x|) or |A r| / (|A| |r|), as the iteration estimates them, is <= this value."},
    kLinearSystem,
    ignored_attribute("graph", "Ignored here."),
    ignored_attribute("verbose", "Ignored here."),
};
inline constexpr Description kMinResLinearSolver{
    .class_name = "MinResLinearSolver",
    .category = "LinearSolver",
    .help = "Minimum residuals without assembled matrix. Begins with the solution of the step before.",
    .templates = kIterativeTemplates,
    .attributes = kMinResLinearSolverAttributes};

inline constexpr Attribute kPCGLinearSolverAttributes[] = {
    {.name = "iterations",
     .type = Type::kInteger,
     .initial = "25",
     .range = {.min = 1, .max = 1e9},
     .help = "Largest number of iterations."},
    {.name = "tolerance",
     .type = Type::kReal,
     .initial = "1e-5",
     .range = kNotNegative,
     .help = "Stops when r.z / b.b <= this value, z being the preconditioned residual: without preconditioner this is "
             "the square of CGLinearSolver's measure."},
    {.name = "use_precond", .type = Type::kBool, .initial = "true", .help = "Whether the preconditioner is used."},
    {.name = "preconditioner",
     .type = Type::kLink,
     .help = "A direct solver or one of SOFA's preconditioners, with the matrix of the current step; default: none. A "
             "direct solver is exact here: one iteration is enough."},
    kLinearSystem,
    ignored_attribute("update_step", "Ignored here: the preconditioner is always up to date."),
    ignored_attribute("graph", "Ignored here."),
};
inline constexpr Description kPCGLinearSolver{
    .class_name = "PCGLinearSolver",
    .category = "LinearSolver",
    .help =
        "Preconditioned conjugate gradients. Begins with the solution of the step "
        "before.",
    .templates = kIterativeTemplates,
    .attributes = kPCGLinearSolverAttributes};

inline constexpr Attribute kDirectSolverAttributes[] = {
    kLinearSystem,
    ignored_attribute("precomputeSymbolicDecomposition", "Ignored here: it is kept as long as the pattern stays."),
    ignored_attribute("orderingMethod", "Ignored here: CHOLMOD chooses the order."),
    ignored_attribute("parallelInverseProduct", "Ignored here."),
    ignored_attribute("verbose", "Ignored here."),
    ignored_attribute("savingPrecision", "Ignored here."),
    ignored_attribute("minSingularValue", "Ignored here: no singular value is cut."),
    ignored_attribute("enableAssembly", "Ignored here: the matrix is always that of the present step."),
    ignored_attribute("use_file", "Ignored here: nothing is precomputed."),
    ignored_attribute("jmjt_twostep", "Ignored here: there are no Lagrangian constraints."),
    ignored_attribute("iterativeSolverNumbering", "Ignored here: CHOLMOD chooses the order."),
    ignored_attribute("symmetric", "Ignored here: the matrix is symmetric."),
    ignored_attribute("exportDataToFolder", "Ignored here."),
};
inline constexpr std::string_view kDirectTemplates =
    "CompressedRowSparseMatrix CompressedRowSparseMatrixd CompressedRowSparseMatrixMat3x3 "
    "CompressedRowSparseMatrixMat3x3d FullMatrix FullMatrixd SparseMatrix SparseMatrixd NewMat BTDMatrix3 BTDMatrix3d";

/// SOFA's exact solvers are one and the same here. others: what SOFA's does otherwise.
constexpr Description direct_solver(std::string_view class_name, std::string_view help) {
  return {.class_name = class_name,
          .category = "LinearSolver",
          .help = help,
          .templates = kDirectTemplates,
          .attributes = kDirectSolverAttributes};
}
inline constexpr std::string_view kDirectHelp =
    "Direct sparse factorisation by CHOLMOD, of the matrix of the present step, for any of these names.";
inline constexpr Description kDirectSolvers[] = {
    direct_solver("SparseLDLSolver", kDirectHelp),
    direct_solver("EigenSimplicialLDLT", kDirectHelp),
    direct_solver("EigenSimplicialLLT", kDirectHelp),
    direct_solver("EigenSparseLU", kDirectHelp),
    direct_solver("EigenSparseQR", kDirectHelp),
    direct_solver("CholeskySolver", kDirectHelp),
    direct_solver("LULinearSolver", kDirectHelp),
    direct_solver("BTDLinearSolver", kDirectHelp),
    direct_solver("SparsePARDISOSolver", kDirectHelp),
    direct_solver("SparseCholeskySolver", kDirectHelp),
    direct_solver("SparseLUSolver", kDirectHelp),
    direct_solver(
        "SVDLinearSolver",
        "Direct sparse factorisation by CHOLMOD, of the matrix of the present step. SOFA's cuts singular values "
        "below 1e-6."),
    direct_solver(
        "AsyncSparseLDLSolver",
        "Direct sparse factorisation by CHOLMOD, of the matrix of the present step. SOFA's goes on with that of "
        "an earlier step while a new one is made, and is not exact then."),
    direct_solver("PrecomputedLinearSolver",
                  "Direct sparse factorisation by CHOLMOD, of the matrix of the present step. SOFA's keeps that of the "
                  "first step, and turns it with the body; it is not exact then."),
};

inline constexpr std::string_view kPreconditionerTemplates =
    "CompressedRowSparseMatrix CompressedRowSparseMatrixd CompressedRowSparseMatrixMat3x3 "
    "CompressedRowSparseMatrixMat3x3d DiagonalMatrix BlockDiagonalMatrix BlockDiagonalMatrix3 SparseMatrix "
    "RotationMatrix RotationMatrixd";
inline constexpr Attribute kPreconditionerAttributes[] = {
    kLinearSystem,
    ignored_attribute("verbose", "Ignored here."),
};
inline constexpr Description kJacobiPreconditioner{.class_name = "JacobiPreconditioner",
                                                   .category = "LinearSolver",
                                                   .help = "The diagonal of the matrix, for PCGLinearSolver.",
                                                   .templates = kPreconditionerTemplates,
                                                   .attributes = kPreconditionerAttributes};
inline constexpr Description kBlockJacobiPreconditioner{
    .class_name = "BlockJacobiPreconditioner",
    .category = "LinearSolver",
    .help = "The 3x3 blocks on the diagonal of the matrix, for PCGLinearSolver.",
    .templates = kPreconditionerTemplates,
    .attributes = kPreconditionerAttributes};

inline constexpr Attribute kSSORPreconditionerAttributes[] = {
    {.name = "omega",
     .type = Type::kReal,
     .initial = "1",
     .range = {.min = 0, .max = 2, .exclusive_min = true, .exclusive_max = true},
     .help = "Factor of over-relaxation."},
    kLinearSystem,
    ignored_attribute("verbose", "Ignored here."),
};
inline constexpr Description kSSORPreconditioner{
    .class_name = "SSORPreconditioner",
    .category = "LinearSolver",
    .help = "A sweep of symmetric successive over-relaxation, for PCGLinearSolver.",
    .templates = kPreconditionerTemplates,
    .attributes = kSSORPreconditionerAttributes};

inline constexpr Attribute kWarpPreconditionerAttributes[] = {
    {.name = "linearSolver",
     .type = Type::kLink,
     .help = "The direct solver or preconditioner that it stands for; default: none, which is an exact factorisation."},
    kLinearSystem,
    ignored_attribute("jmjt_twostep", "Ignored here: there are no Lagrangian constraints."),
    ignored_attribute("use_file", "Ignored here: nothing is precomputed."),
    ignored_attribute("share_matrix", "Ignored here: nothing is precomputed."),
    ignored_attribute("use_rotations", "Ignored here: the matrix is always that of the present step."),
    ignored_attribute("draw_rotations_scale", "Visual: ignored here."),
};
constexpr Description warped_preconditioner(std::string_view class_name) {
  return {.class_name = class_name,
          .category = "LinearSolver",
          .help =
              "For PCGLinearSolver: what its linearSolver makes of the matrix of the present step. SOFA's turns an "
              "earlier matrix with the body, and needs more iterations.",
          .templates = kPreconditionerTemplates,
          .attributes = kWarpPreconditionerAttributes};
}
inline constexpr Description kWarpPreconditioners[] = {warped_preconditioner("WarpPreconditioner"),
                                                       warped_preconditioner("PrecomputedWarpPreconditioner")};

constexpr Attribute assembly_attribute(std::string_view name) {
  return {.name = name,
          .type = Type::kBool,
          .initial = "true",
          .help = "A matrix that is not whole is for pictures of it alone: no solver may link to it here."};
}
inline constexpr Attribute kMatrixLinearSystemAttributes[] = {
    assembly_attribute("assembleStiffness"),
    assembly_attribute("assembleMass"),
    assembly_attribute("assembleDamping"),
    assembly_attribute("assembleGeometricStiffness"),
    assembly_attribute("applyProjectiveConstraints"),
    assembly_attribute("applyMappedComponents"),
    ignored_attribute("checkIndices", "Ignored here: they are always right."),
    ignored_attribute("parallelAssemblyIndependentMatrices", "Ignored here."),
};
/// They organise the assembly of matrices in SOFA.
constexpr Description matrix_system(std::string_view class_name) {
  return {.class_name = class_name,
          .category = "LinearSystem",
          .help = "Where SOFA assembles a matrix. Solvers assemble their own here.",
          .templates = kDirectTemplates,
          .attributes = kMatrixLinearSystemAttributes};
}
inline constexpr Description kMatrixLinearSystems[] = {matrix_system("MatrixLinearSystem"),
                                                       matrix_system("ConstantSparsityPatternSystem")};

}  // namespace hexaplast::attributes
