// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "solve/cg_space.hpp"

/// The loop of all conjugate gradients, and what ends it.
namespace hexaplast {

/// Whether exact_residual can be had.
inline bool has_exact_products(const MatrixFreeSystem& system) {
  return !system.bodies.empty() && std::ranges::all_of(system.bodies, [](const KernelBody& body) {
    return body.device || (body.scratch && (body.exact_operator || body.double_operator));
  });
}

/// Whether products are in single precision, and could be had in double.
inline bool rounds_products(const MatrixFreeSystem& system) {
  return has_exact_products(system) && std::ranges::any_of(system.bodies, [](const KernelBody& body) {
           return body.single_operator && body.exact_operator;
         });
}

/// The device that has all of a system, or null.
inline DeviceVectors* device_of(const MatrixFreeSystem& system) {
  return system.has_one_body() ? device_of(system.bodies.front()) : nullptr;
}

/// b.b; throws NumericalError where it is beyond all numbers, as products of directions would be.
inline double finite_square(ConstPoints b) {
  const double square = hexaplast::dot(b, b);
  if (!std::isfinite(square))
    throw NumericalError("conjugate gradients: the right-hand side or its square is not finite");
  return square;
}

/// p.Ap and r.z of finite vectors; throws NumericalError where the matrix, or its preconditioner, makes none of them.
inline void require_finite(double p_Ap, double r_z) {
  if (!std::isfinite(p_Ap) || !std::isfinite(r_z))
    throw NumericalError(fmt::format(
        "conjugate gradients: the matrix or its preconditioner is not finite (p.Ap = {}, r.z = {})", p_Ap, r_z));
}

[[noreturn]] inline void throw_indefinite(double p_Ap) {
  throw NumericalError(fmt::format("conjugate gradients: the matrix is not positive definite (p.Ap = {})", p_Ap));
}

/// Throws NumericalError where z is not what a positive definite preconditioner makes of r.
inline void require_definite(double r_z) {
  if (r_z < 0)
    throw NumericalError(
        fmt::format("conjugate gradients: the preconditioner is not positive definite (r.z = {})", r_z));
}

/// The loop of all conjugate gradients, on what `begin` has put into `space`; r_r: r.r of it. Returns r.r at the end.
/// Ends after `max` iterations in all, where has_converged(r.r), and where goes_on(r.z, p.Ap) is false.
template <class Converged, class GoesOn>
double iterate(CgSpace& space, double r_r, int max, int& iterations, const Converged& has_converged,
               const GoesOn& goes_on) {
  double rho_before = 0;
  for (bool first = true; iterations < max && !has_converged(r_r); first = false) {
    const double rho = space.precondition();
    const double p_Ap = space.product(first ? 0 : rho / rho_before);
    if (!goes_on(rho, p_Ap)) break;
    r_r = space.advance(rho / p_Ap);
    ++iterations;
    rho_before = rho;
  }
  return r_r;
}

}  // namespace hexaplast
