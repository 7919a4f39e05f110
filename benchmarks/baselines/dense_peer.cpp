// SPDX-License-Identifier: LGPL-2.1-or-later
#include "baselines/dense_peer.hpp"

#include <cmath>
#include <utility>

#include "kinematics/polar.hpp"
#include "mesh/trilinear.hpp"

namespace hexaplast::baselines {
namespace {

/// K_ab of strains that are constant: volume [ mu (g_a.g_b I + g_b g_a^T) + lambda g_a g_b^T ].
Mat3 stiffness_block(const Vec3& g_a, const Vec3& g_b, double volume, Lame lame) {
  return volume *
         (lame.mu * (g_a.dot(g_b) * Mat3::Identity() + g_b * g_a.transpose()) + lame.lambda * g_a * g_b.transpose());
}

/// K u, row by row.
std::array<double, 24> product(const std::array<double, 24 * 24>& K, const std::array<double, 24>& u) {
  std::array<double, 24> q;
  for (int row = 0; row < 24; ++row) {
    double sum = 0;
    for (int column = 0; column < 24; ++column) sum += K[24 * row + column] * u[column];
    q[row] = sum;
  }
  return q;
}

/// -factor Q^T q of each corner.
std::array<double, 24> turned_back(const Mat3& Q, const std::array<double, 24>& q, double factor) {
  std::array<double, 24> f;
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i)
      f[3 * a + i] = -factor * (Q(0, i) * q[3 * a] + Q(1, i) * q[3 * a + 1] + Q(2, i) * q[3 * a + 2]);
  return f;
}

}  // namespace

DensePeer::DensePeer(const HexMesh& mesh, const std::vector<Lame>& lame, Eigen::VectorXd masses, std::vector<int> fixed)
    : hexahedra_(mesh.hexahedra()),
      frames_(hexahedra_.size(), Mat3::Identity()),
      masses_(std::move(masses)),
      fixed_(std::move(fixed)) {
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    rest_.push_back(gather(mesh.positions(), hexahedra_[e]));
    stiffness_.push_back(stiffness(rest_[e], lame[e]));
  }
}

DensePeer::Matrix24 DensePeer::stiffness(const ElementPoints& X, Lame lame) {
  Matrix24 K;
  K.fill(0);
  for_each_gauss_point(X, [&](const ElementPoints& dN, const Mat3& J) {
    const ElementPoints g = dN * J.inverse();
    const double volume = J.determinant();
    for (int a = 0; a < kCorners; ++a)
      for (int b = 0; b < kCorners; ++b) {
        const Mat3 block = stiffness_block(g.row(a), g.row(b), volume, lame);
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) K[(3 * a + i) * 24 + 3 * b + j] += block(i, j);
      }
  });
  return K;
}

/// force_of(e): forces on the corners of a hexahedron.
template <class ForceOf>
void DensePeer::add_forces(const ForceOf& force_of, Points f) const {
  double* to = f.data();
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    const Vec24 force = force_of(e);
    for (int a = 0; a < kCorners; ++a)
      for (int i = 0; i < 3; ++i) to[3 * std::size_t(hexahedra_[e][a]) + i] += force[3 * a + i];
  }
}

void DensePeer::add_force(ConstPoints x, Points f) {
  const double* from = x.data();
  add_forces(
      [&](std::size_t e) {
        const ElementPoints& X = rest_[e];
        const Mat3 F = centre_jacobian(gather(x, hexahedra_[e])) * centre_jacobian(X).inverse();
        const Mat3 Q = frames_[e] = polar(F).R.transpose();
        Vec24 u;
        for (int a = 0; a < kCorners; ++a) {
          const double* at = from + 3 * std::size_t(hexahedra_[e][a]);
          for (int i = 0; i < 3; ++i) u[3 * a + i] = Q(i, 0) * at[0] + Q(i, 1) * at[1] + Q(i, 2) * at[2] - X(a, i);
        }
        return turned_back(Q, product(stiffness_[e], u), 1);
      },
      f);
}

void DensePeer::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  const double* from = dx.data();
  add_forces(
      [&](std::size_t e) {
        const Mat3& Q = frames_[e];
        Vec24 u;
        for (int a = 0; a < kCorners; ++a) {
          const double* at = from + 3 * std::size_t(hexahedra_[e][a]);
          for (int i = 0; i < 3; ++i) u[3 * a + i] = Q(i, 0) * at[0] + Q(i, 1) * at[1] + Q(i, 2) * at[2];
        }
        return turned_back(Q, product(stiffness_[e], u), factor);
      },
      df);
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
