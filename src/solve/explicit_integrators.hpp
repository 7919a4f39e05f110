// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/solve/implicit_euler.hpp"

namespace hexaplast {

/// Schemes that find the acceleration a(x, v) = M^-1 f(t, x, v) and never ask for the stiffness: SOFA's, in its order
/// of evaluation. h is the time step. As in SOFA, loads and constraints are those of the step's beginning t in all
/// evaluations: what depends on time is of first order.
enum class ExplicitScheme {
  kEuler,             ///< x += h v,  v += h a
  kSymplecticEuler,   ///< v += h a,  x += h v
  kMidpoint,          ///< a' at x + h/2 v, v + h/2 a:  x += h (v + h/2 a),  v += h a'
  kRungeKutta4,       ///< the classical one of four evaluations
  kCentralDifference  ///< v = ((1/h - r/2) v + a) / (1/h + r/2),  x += h v;  r: damping by the mass
};

/// The product of dt [s] and the angular frequency of an undamped vibration below which steps do not make it grow; 0:
/// they always do, if only slowly.
double stable_phase_per_step(ExplicitScheme scheme);

/// One step of an explicit scheme. It is stable below a time step that the fastest vibration sets, and nothing is
/// solved for where masses do not couple nodes.
class ExplicitIntegrator {
 public:
  /// rayleigh_mass [1/s]: of kCentralDifference alone.
  explicit ExplicitIntegrator(ExplicitScheme scheme, double rayleigh_mass = 0)
      : scheme_(scheme), rayleigh_mass_(rayleigh_mass) {}

  /// Advances x [m] and v [m/s] by dt [s]. solver: of M a = f, where masses couple nodes; null where they do not.
  /// Throws NumericalError naming the first node that left the finite numbers, as one without mass does, InputError for
  /// other sizes and where a solver is missing; x and v are then as before, but for what constraints prescribe.
  SolveReport step(MechanicalSystem& system, LinearSolver* solver, double time, double dt, Points x, Points v);

  SolverMemory& memory() { return memory_; }

 private:
  void find_acceleration(MechanicalSystem& system, LinearSolver* solver, double time, ConstPoints x, ConstPoints v,
                         PointArray& a);
  void find_prescribed_acceleration(MechanicalSystem& system, LinearSolver* solver, double time, Points x, Points v,
                                    PointArray& a);
  void step_by_midpoint(MechanicalSystem& system, LinearSolver* solver, double time, double h, Points x, Points v);
  void step_by_runge_kutta(MechanicalSystem& system, LinearSolver* solver, double time, double h, Points x, Points v);

  ExplicitScheme scheme_;
  double rayleigh_mass_;
  SolverMemory memory_;
  SolveReport report_;
  PointArray force_, x_, a_[4], v_[4];  // scratch: of the stages
};

}  // namespace hexaplast
