// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/solve/energy_balance.hpp"

namespace hexaplast {

/// Factors of the operator m M + b B + k K with K = df/dx, B = df/dv (SOFA's signs: K is negative semi-definite).
struct OperatorFactors {
  double mass = 0;
  double damping = 0;
  double stiffness = 0;
};

/// A mechanical system as a time integrator sees it: nodal masses, forces, constraints, over num_nodes nodes.
class MechanicalSystem {
 public:
  virtual ~MechanicalSystem() = default;

  virtual int num_nodes() const = 0;

  /// The forces that follow are those of a step of dt [s]; infinite: of an equilibrium.
  virtual void set_time_step(double /*dt*/) {}

  /// f = all forces at (x, v, time), gravity included; fixes the positions at which add_product and add_blocks act.
  virtual void compute_force(double time, ConstPoints x, ConstPoints v, Points f) = 0;

  /// df += (m M + b B + k K) dx.
  virtual void add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const = 0;

  /// A += m M + b B + k K as blocks.
  virtual void add_blocks(const OperatorFactors& factors, BlockMatrix& A) const = 0;

  /// The same operator for the kernels: bodies, others and what is added to the diagonal of `system`. False where the
  /// kernels are not to be used.
  virtual bool add_operator(const OperatorFactors& /*factors*/, MatrixFreeSystem& /*system*/) const { return false; }

  /// f += those forces of compute_force that are no body's elasticity, df += (b B + k K) dx of the same forces: what
  /// the accounts of energy (ImplicitEuler::measure_energy) take for loads. K and B are symmetric. The default is none.
  virtual void add_load(double /*time*/, ConstPoints /*x*/, ConstPoints /*v*/, Points /*f*/) {}
  virtual void add_load_product(const OperatorFactors& /*factors*/, ConstPoints /*dx*/, Points /*df*/) const {}

  /// Releases one-sided forces that would pull at the end of a step that goes from (x, v) to (x_end, v_end), and adds
  /// what that changes: force += the change of compute_force(time, x, v), product += that of K v. Returns whether there
  /// were any: the step is then solved again, and this is called again, so that it must come to an end. The default has
  /// no such forces.
  virtual bool release(double /*time*/, ConstPoints /*x*/, ConstPoints /*v*/, ConstPoints /*x_end*/,
                       ConstPoints /*v_end*/, Points /*force*/, Points /*product*/) {
    return false;
  }

  /// Puts x and v where constraints prescribe them at that time, within a step; the default prescribes nothing.
  virtual void prescribe(double /*time*/, Points /*x*/, Points /*v*/) const {}

  /// What constraints leave free in the step, or the equilibrium, that is being solved. `constraints` is reset before;
  /// the default constrains nothing.
  virtual void constrain(Constraints& /*constraints*/) const {}
};

struct EulerSettings {
  double rayleigh_mass = 0;       ///< [1/s]
  double rayleigh_stiffness = 0;  ///< [s]
  double velocity_damping = 0;    ///< [1/s]
  bool first_order = false;       ///< M v = f instead of M dv/dt = f
  bool trapezoidal = false;       ///< forces at the middle of the step; stable below stable_phase_per_step only
};

/// The product of dt [s] and the angular frequency of a vibration below which steps do not make it grow, whatever
/// that frequency is: 2 in the trapezoidal scheme without velocity damping, no bound in the others.    theory.md eq. 49
double stable_phase_per_step(const EulerSettings& settings, double dt);

/// One step of linearised implicit Euler, as SOFA's EulerImplicitSolver defines it:             theory.md eq. 40-42
///
///   A  = (1 + a h rM) M - a h B - a h (a h + rK) K        a = 1, or 1/2 when trapezoidal
///   b  = h [ f - rM M v + (a h + rK) K v ]
///   A dv = b  (both projected),  v += dv,  x += h v,  and then v *= exp(-h velocity_damping)
///
/// first_order:  (M - a h K) v = f  (both projected),  x += h v
///
/// One linear solve per step, no iteration on the nonlinearity; more of them where forces are released
/// (MechanicalSystem::release).
class ImplicitEuler {
 public:
  explicit ImplicitEuler(EulerSettings settings) : settings_(settings) {}

  /// Advances x [m] and v [m/s] by dt [s]. Throws NumericalError naming the first node that left the finite numbers,
  /// InputError where x or v has not one row per node of the system; x and v are then as before.
  SolveReport step(MechanicalSystem& system, LinearSolver& solver, double time, double dt, Points x, Points v);

  /// A dv = b of a step, and again while `release(dv, b)` has released what would pull at the end of the step that dv
  /// leads to, and has added to b what that changes. At the end nothing pulls.
  template <class Release>
  static SolveReport solve(LinearSolver& solver, const LinearSystem& A, PointArray& b, PointArray& dv,
                           SolverMemory& memory, const Release& release) {
    SolveReport report = solver.solve_next(A, b, dv, memory);
    while (release(dv, b)) report.add(solver.solve_from_guess(A, b, dv, memory));
    return report;
  }

  /// Lets `release()` take out what would pull at the end of the step, and adds what that changes: force += the change
  /// of what add_force(f) adds to f (scratch of the size of force), and product by add_product(sign), which adds sign K
  /// v. What release returns: whether there was anything.
  template <class AddForce, class AddProduct, class Release>
  static bool release_from(Points force, PointArray& scratch, const AddForce& add_force, const AddProduct& add_product,
                           const Release& release) {
    const auto add = [&](double sign) {
      scratch.setZero(force.rows(), 3);
      add_force(scratch);
      force += sign * scratch;
      add_product(sign);
    };
    add(-1);
    const bool has_released = release();
    add(1);
    return has_released;
  }

  /// b += P h (f + (a h + rK) K v), for a change of f and one of K v; `force` is changed too.
  static void add_released(double h, double of_product, PointArray& force, const PointArray& product,
                           const Constraints& constraints, PointArray& b) {
    force = h * (force + of_product * product);
    constraints.project(force);
    b += force;
  }

  /// What the steps so far have left for the linear solver of the next one. It belongs to x and v: where
  /// others take their place, as after a step that has thrown, theirs are put here, or it is reset.
  SolverMemory& memory() { return memory_; }
  const SolverMemory& memory() const { return memory_; }

  /// From now on each step also tells what it did to the energy, at the cost of about one product more. The motion is
  /// the same, bit for bit.
  void measure_energy() { measures_energy_ = true; }
  const StepEnergy& energy() const { return energy_; }  ///< of the latest step; zeros where it is not measured

  /// [N] on each node, in the latest step: by which constraints hold nodes or prescribe their motion, zero on free
  /// degrees of freedom. They are exactly what the step's equation lacks there. No rows before a step whose energy is
  /// measured.
  PointArray support_forces() const { return -force_; }  //  theory.md eq. 45

 private:
  StepEnergy energy_of_step(MechanicalSystem& system, double time, double h, ConstPoints x, ConstPoints v);

  EulerSettings settings_;
  SolverMemory memory_;
  Constraints constraints_;  // of the present step
  bool measures_energy_ = false;
  StepEnergy energy_;
  PointArray right_hand_side_, velocity_;           // [kg m/s] or [N], and [m/s]: dv, then the new velocity
  PointArray released_, released_product_;          // scratch: changes of force [N] and product
  PointArray end_, end_velocity_;                   // scratch: where the step may end
  PointArray force_ = PointArray(0, 3);             // [N] of the supports, with the sign turned
  PointArray increment_, middle_, product_, load_;  // scratch of energy_of_step
};

}  // namespace hexaplast
