// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/relaxation.hpp"

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "hexaplast/solve/cholesky.hpp"
#include "support/cantilever.hpp"
#include "support/dense.hpp"
#include "support/shapes.hpp"
#include "support/simulation.hpp"

namespace hexaplast::support {
namespace {

constexpr double kYoung = 5000, kPoissonRatio = 0.3, kShear = kYoung / (2 * (1 + kPoissonRatio)),
                 kBulk = kYoung / (3 * (1 - 2 * kPoissonRatio));
const Eigen::Vector2d kModuli(1, 0.5), kTimes(0.5, 5);  // g [-] and t [s] of the branches

constexpr double kStrain = 1e-5, kForce = 1e-6;  // [-], [N]
constexpr double kLength = 1, kWidth = 0.1;      // [m] of the beam
constexpr double kBendingShare =
                     kForce * kLength * kLength * kLength * 4 / (kYoung * kWidth * kWidth * kWidth * kWidth),
                 kShearingShare = kForce * kLength / (5.0 / 6 * kShear * kWidth * kWidth);  // [m] of slow deflection

}  // namespace

std::vector<double> relax(const std::string& name, const std::vector<double>& times) {
  constexpr double kJump = 1e-9;  // [s]
  constexpr int kSteps = 20;      // from one time to the next
  const bool is_beam = name.ends_with("beam"), is_loaded = is_beam || name == "loaded bar",
             is_shear = name == "held shear";
  const BeamMesh beam = beam_mesh(name == "loaded thin beam" ? "one cell thick" : "cubes");
  Body body(is_beam ? beam.mesh : block({1, 1, 1}, 1), {{.young_modulus = kYoung, .poisson_ratio = kPoissonRatio}},
            {.relaxation = {kModuli[0], kTimes[0], kModuli[1], kTimes[1]}});
  const PointArray& X = body.mesh().positions();
  const std::vector<int> end = nodes_at(body.mesh(), is_shear ? 2 : 0, 1);
  const int axis = is_beam ? 2 : 0;  // of what is read
  const std::vector<double> weights = is_beam ? beam.weights : std::vector(end.size(), 0.25);

  std::vector<GuidedBody::Held> held;
  for (int n = 0; n < X.rows(); ++n)
    for (int k = 0; k < 3; ++k)
      if (is_shear || X(n, is_beam ? 0 : k) == 0 || (!is_loaded && k == 0)) held.push_back({n, k});
  GuidedBody system(body, held, [&](double, ConstPoints, Points f) {
    for (std::size_t k = 0; is_loaded && k < end.size(); ++k)
      f(end[k], axis) += (is_beam ? kForce : kStrain * kYoung) * weights[k];
  });
  PointArray x = X, v = PointArray::Zero(X.rows(), 3);
  if (!is_loaded) x.col(0) += kStrain * X.col(is_shear ? 2 : 0);

  ImplicitEuler euler({});  // without mass: equilibrium at the end of each step
  CholeskySolver solver;
  std::vector<double> values;
  double before = -kJump;
  for (const double time : times) {
    const int steps = values.empty() ? 1 : kSteps;
    for (int step = 0; step < steps; ++step) {
      const double dt = (time - before) / steps;
      euler.step(system, solver, 0, dt, x, v);
      body.flow(x, dt);
    }
    before = time;
    body.set_time_step(0);
    const PointArray f = force_at(body, x);
    double sum = 0;
    for (std::size_t k = 0; k < end.size(); ++k)
      sum += is_loaded ? weights[k] * (x(end[k], axis) - X(end[k], axis)) : -f(end[k], axis);
    const double slow = is_beam ? kBendingShare + kShearingShare : kStrain;
    values.push_back(sum / slow / (is_loaded ? 1 : is_shear ? kShear : kYoung));
  }
  return values;
}

std::vector<double> relax_in_theory(const std::string& name, const std::vector<double>& times) {
  const double all = 1 + kModuli.sum();
  // strain e = strain_now + share sum g a under a load that is held, where t da/dt = e - a in each branch
  const auto strain = [&](double strain_now, double share, double time) {
    const Eigen::Vector2d rates = kTimes.cwiseInverse();
    const Eigen::Matrix2d A =
        rates.asDiagonal() * (share * Eigen::Vector2d::Ones() * kModuli.transpose() - Eigen::Matrix2d::Identity());
    const Eigen::Vector2d a = A.inverse() * ((A * time).exp() - Eigen::Matrix2d::Identity()) * rates * strain_now;
    return strain_now + share * kModuli.dot(a);
  };
  std::vector<double> values;
  for (const double time : times) {
    const double shear = strain(1 / all, 1 / all, time),
                 bar = kYoung / (9 * kBulk) + kYoung / (3 * kShear) * shear;  // creep of both, over the slow ones
    const double stiffness = 9 * kBulk + 3 * kShear * all;                    // of a bar whose length is held
    if (name == "held shear")
      values.push_back(1 + kModuli.dot((-time * kTimes.cwiseInverse()).array().exp().matrix()));
    else if (name == "held bar")
      values.push_back(9 * kBulk / kYoung * (1 - strain(9 * kBulk / stiffness, 3 * kShear / stiffness, time)));
    else if (name == "loaded bar")
      values.push_back(bar);
    else
      values.push_back((kBendingShare * bar + kShearingShare * shear) / (kBendingShare + kShearingShare));
  }
  return values;
}

}  // namespace hexaplast::support
