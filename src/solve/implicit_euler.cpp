// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/implicit_euler.hpp"

#include <cmath>
#include <limits>

#include "base/require.hpp"
#include "solve/constrained_operator.hpp"

namespace hexaplast {

double stable_phase_per_step(const EulerSettings& settings, double dt) {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  if (!settings.trapezoidal || settings.first_order) return kUnbounded;
  const double t = std::tanh(dt * settings.velocity_damping / 2);
  const double stiffness_fraction = 1 - 2 * settings.rayleigh_stiffness * t / dt;
  if (stiffness_fraction <= 0) return kUnbounded;
  return std::sqrt((4 + 2 * dt * settings.rayleigh_mass * t) / stiffness_fraction);  //                           eq. 49
}

SolveReport ImplicitEuler::step(MechanicalSystem& system, LinearSolver& solver, double time, double dt, Points x,
                                Points v) {
  require_rows("ImplicitEuler::step", "x", x, system.num_nodes());
  require_rows("ImplicitEuler::step", "v", v, system.num_nodes());
  system.set_time_step(dt);
  constraints_.reset(system.num_nodes());
  system.constrain(constraints_);
  const double h = dt, ah = settings_.trapezoidal ? h / 2 : h;
  const double rM = settings_.rayleigh_mass, rK = settings_.rayleigh_stiffness;
  const bool first_order = settings_.first_order;
  right_hand_side_.resize(x.rows(), 3);
  velocity_.resize(x.rows(), 3);

  // b = h [ f - rM M v + (a h + rK) K v ]                                                                     eq. 41
  system.compute_force(time, x, v, right_hand_side_);
  if (measures_energy_) force_ = right_hand_side_;
  if (!first_order) {
    system.add_product({.mass = -rM, .damping = 0, .stiffness = ah + rK}, v, right_hand_side_);
    right_hand_side_ *= h;
  }
  constraints_.project(right_hand_side_);
  require_finite(right_hand_side_, "force");  // before the solver, which would spread it over all nodes

  // A = (1 + a h rM) M - a h B - a h (a h + rK) K                                                             eq. 40
  const OperatorFactors factors =
      first_order ? OperatorFactors{.mass = 1, .damping = 0, .stiffness = -ah}
                  : OperatorFactors{.mass = 1 + ah * rM, .damping = -ah, .stiffness = -ah * (ah + rK)};
  const ConstrainedOperator A(system, factors, constraints_);
  const SolveReport report =
      solve(solver, A, right_hand_side_, velocity_, memory_, [&](const PointArray& dv, PointArray& b) {
        released_.setZero(x.rows(), 3);
        released_product_.setZero(x.rows(), 3);
        end_velocity_ = dv;
        if (!first_order) end_velocity_ += v;
        end_ = x + h * end_velocity_;
        if (!system.release(time, x, v, end_, end_velocity_, released_, released_product_)) return false;
        if (measures_energy_) force_ += released_;
        add_released(first_order ? 1 : h, first_order ? 0 : ah + rK, released_, released_product_, constraints_, b);
        return true;
      });

  if (!first_order) velocity_ += v;  //                                                                        eq. 42
  require_finite(velocity_, "velocity");
  if (measures_energy_) energy_ = energy_of_step(system, time, h, x, v);
  x += h * velocity_;
  // positions have moved by then: the decay acts on the steps that follow
  v = std::exp(-h * settings_.velocity_damping) * velocity_;
  return report;
}

// With v' = v + dv, v_a = v + a dv and the displacement h v', the solved system says that on free degrees of freedom
//
//   M dv = h [ f - rM M v_a + a B dv + (a h + rK) K v_a ]
//
// Times v', term by term. The first order scheme is the same with dv = 0, rM = 1 (in 1/s) and rK = 0: mass drags.
StepEnergy ImplicitEuler::energy_of_step(MechanicalSystem& system, double time, double h, ConstPoints x,
                                         ConstPoints v) {
  const bool first_order = settings_.first_order;
  const double a = settings_.trapezoidal ? 0.5 : 1, rM = first_order ? 1 : settings_.rayleigh_mass,
               rK = first_order ? 0 : settings_.rayleigh_stiffness;
  if (first_order)
    increment_.setZero(v.rows(), 3);
  else
    increment_ = velocity_ - v;
  middle_ = velocity_ - (1 - a) * increment_;
  const auto product = [&](const OperatorFactors& factors, const PointArray& field) -> const PointArray& {
    product_.setZero(field.rows(), 3);
    system.add_product(factors, field, product_);
    return product_;
  };
  const auto load_product = [&](const OperatorFactors& factors, const PointArray& field) -> const PointArray& {
    load_.setZero(field.rows(), 3);
    system.add_load_product(factors, field, load_);
    return load_;
  };
  const auto work = [&](const PointArray& force) { return h * force.cwiseProduct(velocity_).sum(); };

  StepEnergy energy;
  // loads without their dampers, then with them: the latter leave the system as compute_force did              eq. 44
  load_.setZero(x.rows(), 3);
  product_.setZero(x.rows(), 3);
  system.add_load(time, x, product_, load_);
  energy.load_work = work(load_);
  load_.setZero();
  system.add_load(time, x, v, load_);
  energy.damping_loss = energy.load_work - work(load_);

  // the forces that are missing to M dv / h are those of the supports; force_ becomes them, with the sign turned
  product({.mass = 1, .damping = 0, .stiffness = 0}, increment_);
  force_ -= product_ / h;
  energy.numerical_loss = increment_.cwiseProduct(product_).sum() / 2;  //                                     eq. 47
  product({.mass = 1, .damping = 0, .stiffness = 0}, middle_);
  force_ -= rM * product_;
  energy.damping_loss += rM * work(product_);  //                                                              eq. 46
  product({.mass = 0, .damping = 1, .stiffness = 0}, increment_);
  force_ += a * product_;
  energy.damping_loss -= a * work(product_);
  product({.mass = 0, .damping = 0, .stiffness = 1}, middle_);
  force_ += (a * h + rK) * product_;
  energy.damping_loss -= rK * work(product_);

  load_product({.mass = 0, .damping = 0, .stiffness = 1}, middle_);
  energy.load_work += a * h * work(load_);
  // what forces at a fixed moment do beyond the change of a quadratic energy: h v'.K (h v' / 2 - a h v_a)       eq. 47
  if (settings_.trapezoidal) {
    product({.mass = 0, .damping = 0, .stiffness = 1}, increment_);
    load_product({.mass = 0, .damping = 0, .stiffness = 1}, increment_);
  }
  product_ -= load_;
  energy.numerical_loss += (settings_.trapezoidal ? h / 4 : -h / 2) * work(product_);

  product_ = force_;
  constraints_.project(product_);
  force_ -= product_;
  energy.support_work = -work(force_);  //                                                                     eq. 45

  if (!first_order && settings_.velocity_damping > 0) {
    product({.mass = 1, .damping = 0, .stiffness = 0}, velocity_);
    energy.damping_loss += -std::expm1(-2 * h * settings_.velocity_damping) / 2 * work(product_) / h;
  }
  return energy;
}

}  // namespace hexaplast
