// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast {

/// a = M^-1 f on free degrees of freedom, 0 on the others. `force` becomes scratch. Where masses couple nodes, `solver`
/// solves for it; InputError without one. Throws NumericalError where a is not finite.
SolveReport solve_for_acceleration(const MechanicalSystem& system, LinearSolver* solver, SolverMemory& memory,
                                   PointArray& force, PointArray& a);

}  // namespace hexaplast
