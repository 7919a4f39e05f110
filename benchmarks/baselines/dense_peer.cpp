// SPDX-License-Identifier: LGPL-2.1-or-later
#include "baselines/dense_peer.hpp"

#include <cmath>
#include <utility>

namespace hexaplast::baselines {

DensePeer::DensePeer(const HexMesh& mesh, const std::vector<Lame>& lame, Eigen::VectorXd masses, std::vector<int> fixed)
    : hexahedra_(mesh.positions(), mesh.hexahedra(), lame, {.frame = ElementFrame::kGradient}),
      masses_(std::move(masses)),
      fixed_(std::move(fixed)) {}

void DensePeer::project(PointArray& field) const {
  for (const int n : fixed_) field.row(n).setZero();
}

SolveReport DensePeer::step(const Vec3& gravity, double dt, const Stop& stop, Points x, Points v, Points dv) {
  // A = M + dt^2 K,  b = dt (f - dt K v)
  residual_ = masses_ * gravity.transpose();
  add_force(x, residual_);
  add_stiffness_product(dt, v, residual_);
  residual_ *= dt;
  project(residual_);

  SolveReport report;
  dv.setZero();
  const double norm_b = residual_.norm();
  product_.resize(x.rows(), 3);
  direction_ = residual_;
  double rho = residual_.squaredNorm();
  while (report.iterations < stop.iterations && std::sqrt(rho) > stop.tolerance * norm_b) {
    product_ = masses_.asDiagonal() * direction_;
    add_stiffness_product(-dt * dt, direction_, product_);
    project(product_);
    const double alpha = rho / direction_.cwiseProduct(product_).sum();
    dv += alpha * direction_;
    residual_ -= alpha * product_;
    const double rho_before = rho;
    rho = residual_.squaredNorm();
    direction_ = residual_ + (rho / rho_before) * direction_;
    ++report.iterations;
    if (stop.is_enough && stop.is_enough(dv)) break;
  }
  report.residual = norm_b > 0 ? std::sqrt(rho) / norm_b : 0;
  report.converged = report.residual <= stop.tolerance;
  v += dv;
  x += dt * v;
  return report;
}

}  // namespace hexaplast::baselines
