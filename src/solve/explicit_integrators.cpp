// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/explicit_integrators.hpp"

#include <algorithm>
#include <cmath>

#include "base/finite.hpp"
#include "base/require.hpp"
#include "solve/acceleration.hpp"

namespace hexaplast {

double stable_phase_per_step(ExplicitScheme scheme) {
  switch (scheme) {
    case ExplicitScheme::kSymplecticEuler:
    case ExplicitScheme::kCentralDifference:
      return 2;
    case ExplicitScheme::kRungeKutta4:
      return std::sqrt(8.0);
    case ExplicitScheme::kEuler:
    case ExplicitScheme::kMidpoint:
      return 0;
  }
  return 0;
}

void ExplicitIntegrator::find_acceleration(MechanicalSystem& system, LinearSolver* solver, double time, ConstPoints x,
                                           ConstPoints v, PointArray& a) {
  force_.resize(x.rows(), 3);
  system.compute_force(time, x, v, force_);
  const SolveReport report = solve_for_acceleration(system, solver, memory_, force_, a);
  report_.iterations += report.iterations;
  report_.residual = std::max(report_.residual, report.residual);
  report_.converged = report_.converged && report.converged;
  report_.preconditioner = report.preconditioner;
}

void ExplicitIntegrator::find_prescribed_acceleration(MechanicalSystem& system, LinearSolver* solver, double time,
                                                      Points x, Points v, PointArray& a) {
  system.prescribe(time, x, v);
  find_acceleration(system, solver, time, x, v, a);
}

SolveReport ExplicitIntegrator::step(MechanicalSystem& system, LinearSolver* solver, double time, double dt, Points x,
                                     Points v) {
  require_rows("ExplicitIntegrator::step", "x", x, system.num_nodes());
  require_rows("ExplicitIntegrator::step", "v", v, system.num_nodes());
  const double h = dt;
  report_ = {};
  switch (scheme_) {
    case ExplicitScheme::kEuler:
      find_acceleration(system, solver, time, x, v, a_[0]);
      x += h * v;
      v += h * a_[0];
      break;
    case ExplicitScheme::kSymplecticEuler:
      find_acceleration(system, solver, time, x, v, a_[0]);
      v += h * a_[0];
      x += h * v;
      break;
    case ExplicitScheme::kCentralDifference: {
      find_acceleration(system, solver, time, x, v, a_[0]);
      const double before = 1 / h - rayleigh_mass_ / 2, after = 1 / h + rayleigh_mass_ / 2;
      v = before / after * v + a_[0] / after;
      x += h * v;
      break;
    }
    case ExplicitScheme::kMidpoint:
      step_by_midpoint(system, solver, time, h, x, v);
      break;
    case ExplicitScheme::kRungeKutta4:
      step_by_runge_kutta(system, solver, time, h, x, v);
      break;
  }
  return report_;
}

void ExplicitIntegrator::step_by_midpoint(MechanicalSystem& system, LinearSolver* solver, double time, double h,
                                          Points x, Points v) {
  find_prescribed_acceleration(system, solver, time, x, v, a_[0]);
  x_ = x + h / 2 * v;
  v_[0] = v + h / 2 * a_[0];
  find_prescribed_acceleration(system, solver, time, x_, v_[0], a_[1]);
  x += h * v_[0];
  v += h * a_[1];
}

void ExplicitIntegrator::step_by_runge_kutta(MechanicalSystem& system, LinearSolver* solver, double time, double h,
                                             Points x, Points v) {
  find_prescribed_acceleration(system, solver, time, x, v, a_[0]);
  const double until[] = {h / 2, h / 2, h};
  v_[0] = v;
  for (int stage = 0; stage < 3; ++stage) {
    x_ = x + until[stage] * v_[stage];
    v_[stage + 1] = v + until[stage] * a_[stage];
    find_prescribed_acceleration(system, solver, time, x_, v_[stage + 1], a_[stage + 1]);
  }
  x += h / 6 * v_[0] + h / 3 * v_[1] + h / 3 * v_[2] + h / 6 * v_[3];
  v += h / 6 * a_[0] + h / 3 * a_[1] + h / 3 * a_[2] + h / 6 * a_[3];
}

}  // namespace hexaplast
