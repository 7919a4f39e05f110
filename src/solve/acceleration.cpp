// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/acceleration.hpp"

#include "base/finite.hpp"
#include "hexaplast/base/error.hpp"
#include "solve/constrained_operator.hpp"

namespace hexaplast {

SolveReport solve_for_acceleration(const MechanicalSystem& system, LinearSolver* solver, SolverMemory& memory,
                                   PointArray& force, PointArray& a) {
  SolveReport report;
  a.setZero(force.rows(), 3);
  if (system.add_mass_diagonal(a)) {
    a = force.cwiseQuotient(a);
    system.project(a);
  } else {
    if (!solver) throw InputError("masses couple nodes: needs lumped masses, or a linear solver");
    system.project(force);
    require_finite(force, "force");
    report = solver->solve_next(ConstrainedOperator(system, {.mass = 1}), force, a, memory);
  }
  require_finite(a, "acceleration");
  return report;
}

}  // namespace hexaplast
