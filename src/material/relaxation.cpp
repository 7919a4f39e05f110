// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/relaxation.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace hexaplast {

namespace {

BranchStep branch_step(double modulus, double time, double h) {
  const double a = h / time;
  if (a == 0) return {modulus, 1, 1, 0, 0, 0};
  if (std::isinf(a)) return {modulus, 0, 0, 1, 0, 0};
  const double lost = -std::expm1(-a), response = lost / a;
  const double moved = a > 0.02 ? (2 * (a - lost) - lost * lost) / (a * a)  // the series: without cancellation
                                : a * (2.0 / 3 - a * (1.0 / 2 - a * (7.0 / 30 - a * (1.0 / 12 - a * 31.0 / 1260))));
  return {modulus, std::exp(-a), response, -std::expm1(-2 * a), 2 * response * lost, moved};
}

}  // namespace

std::vector<BranchStep> branch_steps(const Settings& settings, double h) {
  std::vector<BranchStep> steps;
  for (int k = 0; k < settings.num_branches(); ++k)
    steps.push_back(branch_step(settings.relaxation[2 * k], settings.relaxation[2 * k + 1], h));
  return steps;
}

double Branches::moduli() const {
  double sum = 0;
  for (const BranchStep& step : steps) sum += step.modulus;
  return sum;
}

double Branches::modulus() const {
  double sum = 0;
  for (const BranchStep& step : steps) sum += step.modulus * step.response;
  return sum;
}

Mat3 bounded_balance(const Mat3& q, const Mat3& S) {
  constexpr double kSmallest = 0.1;  // of (s_a + s_b)/|s_a - s_b|; above 1 where nothing is inverted
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(S);
  const Mat3& axes = eigen.eigenvectors();
  const Vec3& s = eigen.eigenvalues();
  Mat3 H = axes.transpose() * q * axes;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const double divisor = std::max(s[a] + s[b], kSmallest * std::abs(s[a] - s[b]));
      if (a != b && divisor > 0) H(a, b) *= 2 * s[a] / divisor;  // 1 + (s_a - s_b)/(s_a + s_b)
    }
  return axes * H * axes.transpose();
}

}  // namespace hexaplast
