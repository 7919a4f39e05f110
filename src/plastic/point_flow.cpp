// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/point_flow.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "material/corotated.hpp"

namespace hexaplast {

double stress_norm(const Mat3& sigma, YieldNorm norm) {
  switch (norm) {
    case YieldNorm::kFrobenius:
      return sigma.norm();
    case YieldNorm::kSpectral:
      return Eigen::SelfAdjointEigenSolver<Mat3>(sigma, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
    case YieldNorm::kVonMises:
      break;
  }
  const Mat3 deviator = sigma - sigma.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

double flow_share(double value, double threshold, double rate, double dt, double offset) {
  if (!(value > threshold)) return 0;
  return std::min(rate * dt * (value - threshold) / (value + offset), 1.0);
}

StretchFlow stretch_flow(const Mat3& S, const Lame& k, YieldNorm norm, double yield_stress, double rate, double dt) {
  const Mat3 sigma = stress(S, k);

  StretchFlow flow;
  flow.norm = stress_norm(sigma, norm);
  flow.share = flow_share(flow.norm, yield_stress, rate, dt);
  if (flow.share == 0) return flow;

  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S);
  const Mat3& V = eigen.eigenvectors();
  const Vec3 log_stretch = eigen.eigenvalues().array().log();
  const Vec3 flowed = flow.share * (log_stretch.array() - log_stretch.mean());   // gamma dev log D
  flow.increment = V * Vec3(flowed.array().exp()).asDiagonal() * V.transpose();  // eq. 22
  flow.strain = std::sqrt(2.0 / 3.0) * flowed.norm();
  flow.dissipated = (V.transpose() * sigma * V).diagonal().dot(flowed);
  return flow;
}

RotationFlow rotation_flow(const Mat3& rotation, double angle, double pose_angle, double rotation_yield, double rate,
                           double dt) {
  RotationFlow flow;
  flow.angle = angle;
  flow.share = flow_share(angle, rotation_yield, rate, dt, pose_angle);       // eq. 25
  if (flow.share > 0) flow.increment = rotation_power(rotation, flow.share);  // eq. 26
  return flow;
}

}  // namespace hexaplast
