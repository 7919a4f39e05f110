// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Time integrators beside EulerImplicitSolver. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kThreadSafeVisitor = ignored_attribute("threadSafeVisitor", "Ignored here.");

inline constexpr Attribute kEulerExplicitAttributes[] = {
    {.name = "symplectic",
     .type = Type::kBool,
     .initial = "true",
     .help = "Whether positions move by the velocity at the end of the step, or by that at its beginning."},
    {.name = "linearSolver",
     .type = Type::kLink,
     .help = "Solves for the acceleration where masses couple nodes (MeshMatrixMass without lumping); default: the "
             "first one of the node, or of the nearest one above."},
    kThreadSafeVisitor,
};
inline constexpr Description kEulerExplicitSolver{
    .class_name = "EulerExplicitSolver",
    .category = "OdeSolver",
    .help =
        "Explicit Euler: one evaluation of the forces per step, and no linear system where masses are lumped. Time "
        "steps must be short: vibrations faster than 2 / dt (rad/s) grow. Keeps no energy balance.",
    .attributes = kEulerExplicitAttributes};

inline constexpr Attribute kNoIntegratorAttributes[] = {kThreadSafeVisitor};
inline constexpr Description kRungeKutta2Solver{
    .class_name = "RungeKutta2Solver",
    .category = "OdeSolver",
    .help =
        "Midpoint rule: two evaluations of the forces per step. Explicit, with lumped masses alone; undamped "
        "vibrations grow slowly at any time step. Keeps no energy balance.",
    .attributes = kNoIntegratorAttributes};

inline constexpr Description kRungeKutta4Solver{
    .class_name = "RungeKutta4Solver",
    .category = "OdeSolver",
    .help =
        "The classical scheme of Runge and Kutta: four evaluations of the forces per step. Explicit, with lumped "
        "masses alone; vibrations faster than 2.8 / dt (rad/s) grow. Keeps no energy balance.",
    .attributes = kNoIntegratorAttributes};

inline constexpr Attribute kCentralDifferenceAttributes[] = {
    {.name = "rayleighMass",
     .type = Type::kReal,
     .initial = "0",
     .unit = "1/s",
     .range = kNotNegative,
     .help = "Mass-proportional damping."},
    kThreadSafeVisitor,
};
inline constexpr Description kCentralDifferenceSolver{
    .class_name = "CentralDifferenceSolver",
    .category = "OdeSolver",
    .help =
        "Central differences (leapfrog): one evaluation of the forces per step. Explicit, with lumped masses alone; "
        "vibrations faster than 2 / dt (rad/s) grow. Keeps no energy balance.",
    .attributes = kCentralDifferenceAttributes};

inline constexpr Attribute kNewmarkAttributes[] = {
    {.name = "gamma",
     .type = Type::kReal,
     .initial = "0.5",
     .range = {.min = 0, .max = 1},
     .help = "Weight of the new acceleration in the new velocity; above 1/2 vibrations decay."},
    {.name = "beta",
     .type = Type::kReal,
     .initial = "0.25",
     .range = {.min = 0, .max = 0.5},
     .help = "Half the weight of the new acceleration in the new positions."},
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
     .help = "Velocities decay as exp(-vdamping dt) at the end of each step."},
    {.name = "linearSolver",
     .type = Type::kLink,
     .help = "Solver of the linear system; default: the first one of the node, or of the nearest one above."},
    kThreadSafeVisitor,
};
inline constexpr Description kNewmarkImplicitSolver{
    .class_name = "NewmarkImplicitSolver",
    .category = "OdeSolver",
    .help =
        "Newmark's scheme, linearised: one linear solve per time step for the acceleration. Keeps no energy balance.",
    .attributes = kNewmarkAttributes};

}  // namespace hexaplast::attributes
