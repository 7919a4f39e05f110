// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/calibration.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hexaplast::runner {
namespace {

constexpr double kFirstStep = 0.2;    // of the box: how far it looks around
constexpr double kLongestStep = 0.3;  // of the box: slopes tell nothing of places that are farther
constexpr double kEnough = 1e-5;      // of the box: steps that are smaller tell nothing more
constexpr double kPerfect = 1e-7;     // root mean square that no measurement comes near
constexpr double kSlopeStep = 0.01;   // of the box, for differences
constexpr double kNoSlope = 1e-9;     // per box: rounding
// In the variance of one row, the decrease of the sum of squares below which it has settled: a step of a thirtieth of
// the standard deviation that noise gives a value, as slopes promise it, and of a tenth, as steps bring it, twice in a
// row.
constexpr double kNoPromise = 1e-3, kNoGain = 1e-2;
constexpr int kIdleSteps = 2;

// The damping, relative to the largest eigenvalue of J^T J: what it begins with, and the multiples tried at once.
constexpr double kFirstDamping = 1e-2, kMinDamping = 1e-12;
constexpr double kMultiples[] = {10, 1, 0.1, 0.01};
constexpr double kMoreDamping = 1e4;  // where none of them was better
constexpr double kStiffOnly = 1e-2;   // damping that leaves the steep directions alone

Eigen::Map<const Eigen::VectorXd> vector_of(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

double mean_square_of(const std::vector<double>& residuals) {
  return vector_of(residuals).squaredNorm() / static_cast<double>(residuals.size());
}

/// Points beside another one, for differences.
std::vector<Point> neighbours_of(const Point& at, double distance) {
  std::vector<Point> points;
  for (std::size_t p = 0; p < at.size(); ++p)
    for (const double step : {-distance, distance}) {
      Point moved = at;
      moved[p] = std::clamp(at[p] + step, 0.0, 1.0);
      if (moved[p] != at[p]) points.push_back(std::move(moved));
    }
  return points;
}

class Search {
 public:
  Search(const Residuals& residuals, const CalibrationOptions& options, const std::function<void(int, double)>& follow)
      : residuals_(residuals), options_(options), follow_(follow) {}

  Calibration from(const Point& start) {
    take({start});
    if (options_.looks_around) take(neighbours_of(found_.best, kFirstStep));
    while (!has_ended()) {
      const std::size_t num_slopes = neighbours_of(found_.best, kSlopeStep).size();
      if (!has_room_for(num_slopes)) break;
      slopes_ = slopes_at([this](const std::vector<Point>& points) { return evaluate(points); }, found_.best,
                          found_.residuals);
      descend();
    }
    return found_;
  }

 private:
  bool has_room_for(std::size_t count) const {
    return found_.num_evaluations + static_cast<int>(count) <= options_.max_evaluations;
  }
  bool has_ended() {
    if (found_.mean_square <= kPerfect * kPerfect) found_.is_converged = true;
    return found_.is_converged || is_out_of_evaluations_;
  }

  std::vector<std::optional<std::vector<double>>> evaluate(const std::vector<Point>& points) {
    std::vector<std::optional<std::vector<double>>> there = residuals_(points);
    found_.num_evaluations += static_cast<int>(points.size());
    found_.num_failed += static_cast<int>(std::ranges::count_if(there, [](const auto& values) { return !values; }));
    follow_(found_.num_evaluations, std::sqrt(found_.mean_square));
    return there;
  }

  /// Evaluates points and keeps the best, the first of equal ones. Its place among them; -1: none is better than what
  /// there was.
  int take(const std::vector<Point>& points) {
    tried_.clear();
    if (!has_room_for(points.size())) {
      is_out_of_evaluations_ = true;
      return -1;
    }
    tried_ = evaluate(points);
    int better = -1;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!tried_[k]) continue;
      const double value = mean_square_of(*tried_[k]);
      if (!found_.best.empty() && !(value < found_.mean_square)) continue;
      found_.best = points[k];
      found_.residuals = *tried_[k];
      found_.mean_square = value;
      better = static_cast<int>(k);
    }
    return better;
  }

  /// Tries steps with the slopes at the best point, with more and more damping, until one is better.
  void descend() {
    const Point at = found_.best;
    const Eigen::VectorXd r = vector_of(found_.residuals);

    // what is at a limit and wants beyond stays there
    std::vector<Eigen::Index> free;
    const Eigen::VectorXd gradient = slopes_.transpose() * r;
    for (Eigen::Index p = 0; p < gradient.size(); ++p) {
      const double place = at[static_cast<std::size_t>(p)];
      if (!(place <= 0 && gradient[p] >= 0) && !(place >= 1 && gradient[p] <= 0)) free.push_back(p);
    }
    const Eigen::MatrixXd J = slopes_(Eigen::all, free);
    if (free.empty() || J.norm() <= kNoSlope) {
      found_.is_converged = true;
      return;
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd &s = svd.singularValues(), along = svd.matrixU().transpose() * r;
    double gain = 0;
    for (Eigen::Index k = 0; k < s.size(); ++k)
      if (s[k] > kNoSlope) gain += along[k] * along[k];
    if (gain <= kNoPromise * found_.mean_square) {
      found_.is_converged = true;
      return;
    }

    const auto moved = [&](const Point& from, const Eigen::VectorXd& r_there, double damping) {
      Eigen::VectorXd step = -svd.matrixV() * (s.array() / (s.array().square() + damping * s[0] * s[0]) *
                                               (svd.matrixU().transpose() * r_there).array())
                                                  .matrix();
      step *= std::min(1.0, kLongestStep / std::max(step.cwiseAbs().maxCoeff(), kLongestStep));
      Point point = from;
      for (std::size_t k = 0; k < free.size(); ++k) {
        double& parameter = point[static_cast<std::size_t>(free[k])];
        parameter = std::clamp(parameter + step[static_cast<Eigen::Index>(k)], 0.0, 1.0);
      }
      return point;
    };
    for (;;) {
      std::vector<Point> points;
      double longest = 0;
      for (const double multiple : kMultiples) {
        points.push_back(moved(at, r, multiple * damping_));
        for (std::size_t p = 0; p < at.size(); ++p) longest = std::max(longest, std::abs(points.back()[p] - at[p]));
      }
      if (longest < kEnough) {
        found_.is_converged = true;
        return;
      }
      const double before = found_.mean_square;
      int better = take(points);
      if (is_out_of_evaluations_) return;
      // long steps leave a curved valley: back into it by the same slopes
      if (better + 1 < static_cast<int>(points.size())) {
        const std::vector<std::optional<std::vector<double>>> there = tried_;
        std::vector<Point> corrected;
        std::vector<int> of;
        for (std::size_t k = 0; k < points.size(); ++k)
          if (there[k]) {
            corrected.push_back(moved(points[k], vector_of(*there[k]), kStiffOnly));
            of.push_back(static_cast<int>(k));
          }
        const int best = take(corrected);
        if (best >= 0) better = of[static_cast<std::size_t>(best)];
      }
      if (better >= 0) {
        damping_ = std::max(kMultiples[better] * damping_, kMinDamping);
        const double gained = (before - found_.mean_square) * static_cast<double>(r.size());
        num_idle_ = gained < kNoGain * before ? num_idle_ + 1 : 0;
        found_.is_converged = num_idle_ == kIdleSteps;
        return;
      }
      if (is_out_of_evaluations_) return;
      damping_ *= kMoreDamping;
    }
  }

  const Residuals& residuals_;
  const CalibrationOptions& options_;
  const std::function<void(int, double)>& follow_;
  Calibration found_;
  Eigen::MatrixXd slopes_;
  std::vector<std::optional<std::vector<double>>> tried_;  // residuals of the points that were taken last
  double damping_ = kFirstDamping;
  int num_idle_ = 0;  // latest steps that brought next to nothing
  bool is_out_of_evaluations_ = false;
};

}  // namespace

Calibration calibrate(const Residuals& residuals, const Point& start, const CalibrationOptions& options,
                      const std::function<void(int, double)>& follow) {
  return Search(residuals, options, follow).from(start);
}

int largest_batch(std::size_t num_parameters) {
  return static_cast<int>(std::max(2 * num_parameters, std::size(kMultiples)));
}

Eigen::MatrixXd slopes_at(const Residuals& residuals, const Point& at, const std::vector<double>& residuals_there) {
  const std::vector<Point> points = neighbours_of(at, kSlopeStep);
  const std::vector<std::optional<std::vector<double>>> beside = residuals(points);

  Eigen::MatrixXd slopes =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(residuals_there.size()), static_cast<Eigen::Index>(at.size()));
  for (std::size_t p = 0; p < at.size(); ++p) {
    Eigen::VectorXd low = vector_of(residuals_there), high = low;
    double from = at[p], to = at[p];
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!beside[k] || points[k][p] == at[p]) continue;
      const bool is_below = points[k][p] < at[p];
      (is_below ? from : to) = points[k][p];
      (is_below ? low : high) = vector_of(*beside[k]);
    }
    if (to > from) slopes.col(static_cast<Eigen::Index>(p)) = (high - low) / (to - from);
  }
  return slopes;
}

std::vector<Uncertainty> uncertainties(const Eigen::MatrixXd& slopes, double distance) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const double reach = distance * std::sqrt(static_cast<double>(slopes.rows()));
  std::vector<Uncertainty> found;
  for (Eigen::Index p = 0; p < slopes.cols(); ++p) {
    // what is left of a column when the others have done what they can; the direction of one that is rounding says
    // nothing
    Eigen::VectorXd rest = slopes.col(p);
    std::vector<Eigen::Index> others;
    for (Eigen::Index q = 0; q < slopes.cols(); ++q)
      if (q != p && slopes.col(q).norm() > kNoSlope) others.push_back(q);
    if (!others.empty()) {
      const Eigen::MatrixXd theirs = slopes(Eigen::all, others);
      rest -= theirs * theirs.colPivHouseholderQr().solve(slopes.col(p));
    }
    const auto uncertainty = [&](const Eigen::VectorXd& slope) {
      return slope.norm() > kNoSlope ? reach / slope.norm() : kInfinite;
    };
    found.push_back({uncertainty(slopes.col(p)), uncertainty(rest)});
  }
  return found;
}

}  // namespace hexaplast::runner
