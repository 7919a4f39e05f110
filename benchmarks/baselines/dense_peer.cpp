// SPDX-License-Identifier: LGPL-2.1-or-later
#include "baselines/dense_peer.hpp"

#include <cmath>

#include "kinematics/polar.hpp"

namespace hexaplast::baselines {

namespace {

/// Shape function gradients [1/m] at s in [-1, 1]^3, and the determinant of the Jacobian [m^3].
struct Gradients {
  ElementPoints at;
  double jacobian;
};

Gradients gradients(const ElementPoints& X, const Vec3& s) {
  ElementPoints local;  // dN_a / ds
  for (int a = 0; a < kCorners; ++a) {
    const Vec3 sign(kCornerSign[a][0], kCornerSign[a][1], kCornerSign[a][2]);
    const Vec3 factor = Vec3::Ones() + sign.cwiseProduct(s);
    local.row(a) << sign[0] * factor[1] * factor[2] / 8, factor[0] * sign[1] * factor[2] / 8,
        factor[0] * factor[1] * sign[2] / 8;
  }
  const Mat3 J = X.transpose() * local;
  return {local * J.inverse(), J.determinant()};
}

}  // namespace

DensePeer::DensePeer(const HexMesh& mesh, const std::vector<Lame>& lame, Eigen::VectorXd masses, std::vector<int> fixed)
    : hexahedra_(mesh.hexahedra()),
      stiffness_(hexahedra_.size()),
      rest_(hexahedra_.size()),
      centre_gradient_(hexahedra_.size()),
      rotation_(hexahedra_.size(), Mat3::Identity()),
      masses_(std::move(masses)),
      fixed_(std::move(fixed)) {
  const double gauss = 1 / std::sqrt(3.0);
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    const ElementPoints& X = rest_[e] = gather(mesh.positions(), hexahedra_[e]);
    centre_gradient_[e] = gradients(X, Vec3::Zero()).at;
    const auto [mu, lambda] = lame[e];
    Matrix24& K = stiffness_[e];
    K.fill(0);
    for (const auto& sign : kCornerSign) {
      const auto [g, volume] = gradients(X, gauss * Vec3(sign[0], sign[1], sign[2]));
      // K_ab = V [ mu (g_a.g_b I + g_b g_a^T) + lambda g_a g_b^T ]
      for (int a = 0; a < kCorners; ++a)
        for (int b = 0; b < kCorners; ++b) {
          const Vec3 g_a = g.row(a), g_b = g.row(b);
          const Mat3 block = volume * (mu * (g_a.dot(g_b) * Mat3::Identity() + g_b * g_a.transpose()) +
                                       lambda * g_a * g_b.transpose());
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) K[(3 * a + i) * 24 + 3 * b + j] += block(i, j);
        }
    }
  }
}

void DensePeer::add_force(ConstPoints x, Points f) {
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    const ElementPoints world = gather(x, hexahedra_[e]);
    const Mat3 R = rotation_[e] = polar(signed_svd(world.transpose() * centre_gradient_[e])).R;
    double u[24], q[24];
    for (int a = 0; a < kCorners; ++a)
      for (int i = 0; i < 3; ++i)
        u[3 * a + i] = R(0, i) * world(a, 0) + R(1, i) * world(a, 1) + R(2, i) * world(a, 2) - rest_[e](a, i);
    for (int row = 0; row < 24; ++row) {
      q[row] = 0;
      for (int column = 0; column < 24; ++column) q[row] += stiffness_[e][24 * row + column] * u[column];
    }
    for (int a = 0; a < kCorners; ++a)
      for (int i = 0; i < 3; ++i)
        f(hexahedra_[e][a], i) -= R(i, 0) * q[3 * a] + R(i, 1) * q[3 * a + 1] + R(i, 2) * q[3 * a + 2];
  }
}

void DensePeer::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  const double* from = dx.data();
  double* to = df.data();
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    const Mat3& R = rotation_[e];
    double u[24], q[24];
    for (int a = 0; a < kCorners; ++a) {
      const double* at = from + 3 * hexahedra_[e][a];
      for (int i = 0; i < 3; ++i) u[3 * a + i] = R(0, i) * at[0] + R(1, i) * at[1] + R(2, i) * at[2];
    }
    const double* K = stiffness_[e].data();
    for (int row = 0; row < 24; ++row) {
      double sum = 0;
      for (int column = 0; column < 24; ++column) sum += K[24 * row + column] * u[column];
      q[row] = factor * sum;
    }
    for (int a = 0; a < kCorners; ++a) {
      double* at = to + 3 * hexahedra_[e][a];
      for (int i = 0; i < 3; ++i) at[i] -= R(i, 0) * q[3 * a] + R(i, 1) * q[3 * a + 1] + R(i, 2) * q[3 * a + 2];
    }
  }
}

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
