// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/conjugate_gradients.hpp"

#include "solve/cg_loop.hpp"

namespace hexaplast {

struct ConjugateGradients::Spaces {
  MatrixFreeSystem system;
  NodalCgSpace nodal;
  SlotCgSpace<double> in_double;
  SlotCgSpace<float> in_single;
  bool rounds = false;  // rounds_products of the present system

  CgSpace& choose(const LinearSystem& A) {
    system.clear();
    const bool is_described = A.matrix_free(system);
    rounds = is_described && rounds_products(system);
    if (DeviceVectors* device = device_of(system)) return device->space(system, nullptr);
    if (is_described && system.is_one_body()) {
      if (system.bodies.front().double_operator) {
        in_double.setup(system, false);
        return in_double;
      }
      in_single.setup(system, false);
      return in_single;
    }
    nodal.setup(A, false, &system.constraints);
    return nodal;
  }
};

ConjugateGradients::ConjugateGradients(ConjugateGradientSettings settings)
    : settings_(settings), spaces_(std::make_unique<Spaces>()) {}
ConjugateGradients::~ConjugateGradients() = default;

SolveReport ConjugateGradients::solve(const LinearSystem& A, ConstPoints b, Points x) {
  SolverMemory none;
  return solve_next(A, b, x, none);
}

SolveReport ConjugateGradients::solve_next(const LinearSystem& A, ConstPoints b, Points x, SolverMemory& memory) {
  require_sizes(A, b, x);
  SolveReport report;

  const double norm_b = std::sqrt(finite_square(b));
  if (norm_b == 0) {
    x.setZero();
    memory.is_first = false;
    return report;
  }

  CgSpace& space = spaces_->choose(A);
  const ConstPoints previous(memory.start);
  const bool warm = settings_.warm_start && previous.rows() == b.rows();
  report.converged = false;
  // SOFA lets the first iteration of the very first solve pass its stopping rules
  const auto must_go_on = [&] { return memory.is_first && report.iterations == 0; };
  const auto is_small = [&](double r_r) { return std::sqrt(r_r) / norm_b <= settings_.tolerance && !must_go_on(); };
  const auto goes_on = [&](double rho, double p_Ap) {
    require_finite(p_Ap, rho);
    report.converged = p_Ap == 0 || (std::abs(p_Ap) <= settings_.threshold && !must_go_on());
    if (p_Ap < 0 && !report.converged) throw_indefinite(p_Ap);
    report.at_threshold = report.converged && p_Ap != 0;
    return !report.converged;
  };
  const double r_r = iterate(space, space.begin(b, warm ? &previous : nullptr), settings_.iterations, report.iterations,
                             is_small, goes_on);
  space.end(x);
  report.residual = std::sqrt(r_r) / norm_b;
  // what products with rounded coefficients leave is not what the system leaves; where nobody asks, it costs nothing
  if (spaces_->rounds && settings_.tolerance > 0)
    report.residual = exact_residual(spaces_->system, b, x, spaces_->system.scratch) / norm_b;
  report.converged = report.converged || report.residual <= settings_.tolerance;
  // a tolerance of 0 asks for iterations, of which a threshold may spare the last ones, and not all
  if (settings_.tolerance > 0 ? report.residual <= settings_.tolerance : report.iterations > 0)
    report.at_threshold = false;
  memory.is_first = false;
  // a start that is no number would spoil every later solve
  if (settings_.warm_start && x.allFinite()) memory.start = x;
  return report;
}

}  // namespace hexaplast
