// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/confidence.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hexaplast::runner {
namespace {

constexpr double kLevel = 0.95;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNoEffect = 1e-9;       // of the largest singular value: rounding
constexpr double kMaxCorrelated = 0.99;  // what short curves can tell from a drift
constexpr double kFewRows = 3;           // beyond those that the parameters use up: too few for a noise of its own
constexpr int kSweeps = 3, kHalvings = 20;

/// Omega X of a first-order autoregressive process: Omega_ij = correlation^|i - j|.
Eigen::MatrixXd correlated(double correlation, const Eigen::MatrixXd& X) {
  Eigen::MatrixXd forward = X, backward = X;
  for (Eigen::Index i = 1; i < X.rows(); ++i) {
    forward.row(i) += correlation * forward.row(i - 1);
    backward.row(X.rows() - 1 - i) += correlation * backward.row(X.rows() - i);
  }
  return forward + backward - X;
}

/// Sums of e_i e_i and e_i e_{i+1}.
struct Moments {
  double square = 0, neighbours = 0;
};

/// A curve's part of a fit: its residuals, and its rows of an orthonormal basis Q of the slopes.
struct Curve {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd Q;
  CurveNoise noise = {};

  Eigen::Index num_rows() const { return residuals.size(); }
  double leverage() const { return Q.squaredNorm(); }  ///< parameters' worth of its rows that the fit has used up
  Eigen::MatrixXd spread(double correlation) const { return Q.transpose() * correlated(correlation, Q); }
  Moments observed() const {
    const Eigen::Index n = num_rows() - 1;
    return {residuals.squaredNorm(), residuals.head(n).dot(residuals.tail(n))};
  }
};

/// What is left of a noise of deviation 1 in a curve, when a fit has taken out what it can, on average; others: sum of
/// deviation^2 spread over the other curves, which comes in through the parameters.
struct Expected {
  Moments own, others;
};

Expected expected(const Curve& curve, double correlation, const Eigen::MatrixXd& others) {
  const Eigen::MatrixXd &Q = curve.Q, W = correlated(correlation, Q);
  const Eigen::Index n = curve.num_rows();
  const auto fitted = [&](const Eigen::MatrixXd& G) {
    const Eigen::MatrixXd QG = Q * G;
    Moments moments{.square = QG.cwiseProduct(Q).sum()};
    for (Eigen::Index i = 0; i + 1 < n; ++i) moments.neighbours += QG.row(i).dot(Q.row(i + 1));
    return moments;
  };
  Expected found{.own = fitted(Q.transpose() * W), .others = fitted(others)};
  found.own.square += static_cast<double>(n) - 2 * W.cwiseProduct(Q).sum();
  found.own.neighbours += static_cast<double>(n - 1) * correlation;
  for (Eigen::Index i = 0; i + 1 < n; ++i)
    found.own.neighbours -= Q.row(i).dot(W.row(i + 1)) + W.row(i).dot(Q.row(i + 1));
  return found;
}

/// Deviation and correlation with which a curve's residuals are as large, and as much alike from row to row, as they
/// are. Residuals themselves are less correlated than the noise: a fit takes out what is slow.
CurveNoise noise_of(const Curve& curve, const Eigen::MatrixXd& others) {
  const Moments observed = curve.observed();
  const auto variance = [&](const Expected& at) {
    return std::max(observed.square - at.others.square, 0.0) / std::max(at.own.square, kNoEffect);
  };
  const auto excess = [&](double correlation) {
    const Expected at = expected(curve, correlation, others);
    return variance(at) * at.own.neighbours + at.others.neighbours - observed.neighbours;
  };
  // rows that alternate are no reason for narrow intervals: 0 at least
  double low = 0, high = kMaxCorrelated;
  for (int i = 0; i < kHalvings && excess(0) < 0; ++i) {
    const double middle = (low + high) / 2;
    (excess(middle) < 0 ? low : high) = middle;
  }
  const double independent = (1 - low) / (1 + low);  // rows that tell as much, per row
  return {.deviation = std::sqrt(variance(expected(curve, low, others))),
          .correlation = low,
          .degrees = std::max(static_cast<double>(curve.num_rows()) * independent - curve.leverage(), 1.0)};
}

void find_noise(std::vector<Curve>& curves, double num_parameters) {
  double sum = 0, rows = 0;
  for (const Curve& curve : curves) {
    sum += curve.residuals.squaredNorm();
    rows += static_cast<double>(curve.num_rows());
  }
  const double degrees = rows - num_parameters;
  for (Curve& curve : curves) curve.noise = {.deviation = std::sqrt(sum / degrees), .degrees = degrees};
  const auto has_few_rows = [](const Curve& curve) {
    return static_cast<double>(curve.num_rows()) - curve.leverage() < kFewRows;
  };
  if (std::ranges::any_of(curves, has_few_rows)) return;  // all have the same noise then

  for (int sweep = 0; sweep < (curves.size() > 1 ? kSweeps : 1); ++sweep)
    for (Curve& curve : curves) {
      Eigen::MatrixXd others = Eigen::MatrixXd::Zero(curve.Q.cols(), curve.Q.cols());
      for (const Curve& other : curves)
        if (&other != &curve)
          others += other.noise.deviation * other.noise.deviation * other.spread(other.noise.correlation);
      curve.noise = noise_of(curve, others);
    }
}

/// Half of an interval whose variance is a sum of estimates with degrees of freedom of their own (Satterthwaite).
double half_width_of(const std::vector<double>& variances, const std::vector<Curve>& curves) {
  double sum = 0, squares = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    sum += variances[c];
    squares += variances[c] * variances[c] / curves[c].noise.degrees;
  }
  return sum > 0 ? student_quantile(kLevel, std::max(sum * sum / squares, 1.0)) * std::sqrt(sum) : 0;
}

}  // namespace

double student_quantile(double level, double degrees) {
  // t = sqrt(degrees) tan(angle) has the density cos(angle)^(degrees - 1) over the angle
  const auto density = [&](double angle) { return std::pow(std::cos(angle), degrees - 1); };
  const double whole =
      std::sqrt(std::numbers::pi) * std::exp(std::lgamma(degrees / 2) - std::lgamma((degrees + 1) / 2));
  const auto probability = [&](double angle) {  // of a size below, by Simpson's rule
    constexpr int kParts = 200;
    double sum = density(0) + density(angle);
    for (int i = 1; i < kParts; ++i) sum += (i % 2 == 0 ? 2 : 4) * density(angle * i / kParts);
    return 2 * sum * angle / (3 * kParts) / whole;
  };
  double low = 0, high = std::min(std::numbers::pi / 2, 40 / std::sqrt(degrees));
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (probability(middle) < level ? low : high) = middle;
  }
  return std::sqrt(degrees) * std::tan(low);
}

Confidence confidence_of(const Eigen::MatrixXd& slopes, const Eigen::VectorXd& residuals,
                         std::span<const Eigen::Index> num_rows, std::span<const Eigen::Index> estimated,
                         double too_wide) {
  const Eigen::Index size = slopes.cols(), num_estimated = static_cast<Eigen::Index>(estimated.size());
  Confidence found{.noise = std::vector<CurveNoise>(num_rows.size()),
                   .half_width = std::vector<double>(static_cast<std::size_t>(size), kInfinite),
                   .correlation = Eigen::MatrixXd::Zero(size, size)};
  const Eigen::MatrixXd J = slopes(Eigen::all, std::vector<Eigen::Index>(estimated.begin(), estimated.end()));
  Eigen::JacobiSVD<Eigen::MatrixXd> svd;
  Eigen::Index rank = 0;
  if (num_estimated > 0) {
    svd.compute(J, Eigen::ComputeThinU | Eigen::ComputeFullV);
    const Eigen::VectorXd& s = svd.singularValues();
    while (rank < s.size() && s[rank] > std::max(kNoEffect * s[0], kNoEffect)) ++rank;
  }
  found.has_noise = residuals.size() > rank;
  const auto name_direction = [&](Eigen::Index k, double half_width) {
    Direction direction{.step = std::vector<double>(static_cast<std::size_t>(size)), .half_width = half_width};
    for (Eigen::Index p = 0; p < num_estimated; ++p)
      direction.step[static_cast<std::size_t>(estimated[static_cast<std::size_t>(p)])] = svd.matrixV()(p, k);
    found.undetermined.push_back(std::move(direction));
  };
  for (Eigen::Index k = rank; k < num_estimated; ++k) name_direction(k, kInfinite);
  if (!found.has_noise) return found;

  std::vector<Curve> curves;
  for (Eigen::Index row = 0; const Eigen::Index count : num_rows) {
    curves.push_back({residuals.segment(row, count), rank > 0
                                                         ? Eigen::MatrixXd(svd.matrixU().block(row, 0, count, rank))
                                                         : Eigen::MatrixXd::Zero(count, 1)});
    row += count;
  }
  find_noise(curves, static_cast<double>(rank));
  for (std::size_t c = 0; c < curves.size(); ++c) found.noise[c] = curves[c].noise;
  if (rank == 0) return found;

  // covariance = V S^-1 (sum of deviation^2 Q^T Omega Q) S^-1 V^T, curve by curve
  const Eigen::MatrixXd V = svd.matrixV().leftCols(rank);
  const Eigen::VectorXd scale = svd.singularValues().head(rank).cwiseInverse();
  std::vector<Eigen::MatrixXd> parts;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(rank, rank);
  for (const Curve& curve : curves) {
    const CurveNoise& noise = curve.noise;
    parts.emplace_back(noise.deviation * noise.deviation * scale.asDiagonal() * curve.spread(noise.correlation) *
                       scale.asDiagonal());
    sum += parts.back();
  }
  const auto half_width_along = [&](const Eigen::VectorXd& along) {
    std::vector<double> variances;
    for (const Eigen::MatrixXd& part : parts) variances.push_back(along.dot(part * along));
    return half_width_of(variances, curves);
  };
  for (Eigen::Index k = 0; k < rank; ++k)
    if (const double half_width = half_width_along(Eigen::VectorXd::Unit(rank, k)); half_width > too_wide)
      name_direction(k, half_width);

  const Eigen::MatrixXd covariance = V * sum * V.transpose();
  constexpr double kTakesPart = 1e-6;  // of a direction of length 1
  for (Eigen::Index p = 0; p < num_estimated; ++p) {
    const Eigen::Index at = estimated[static_cast<std::size_t>(p)];
    const double left_out = rank < num_estimated ? svd.matrixV().row(p).tail(num_estimated - rank).norm() : 0;
    if (left_out > kTakesPart) continue;
    found.half_width[static_cast<std::size_t>(at)] = half_width_along(V.row(p).transpose());
    for (Eigen::Index q = 0; q < num_estimated; ++q)
      if (const double product = covariance(p, p) * covariance(q, q); product > 0)
        found.correlation(at, estimated[static_cast<std::size_t>(q)]) = covariance(p, q) / std::sqrt(product);
  }
  return found;
}

}  // namespace hexaplast::runner
