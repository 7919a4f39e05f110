// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/calibration.hpp"

#include <nlopt.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <new>

namespace hexaplast::runner {
namespace {

constexpr double kFirstStep = 0.2;   // of the box
constexpr double kEnough = 1e-5;     // of the box: steps that are smaller tell nothing more
constexpr double kPerfect = 1e-7;    // root mean square that no measurement comes near
constexpr double kNoResult = 10;     // root mean square that is counted where there is none: ten times what is wanted
constexpr double kSlopeStep = 0.01;  // of the box, for differences
constexpr double kNoSlope = 1e-9;    // per box: rounding

double mean_square_of(const std::vector<double>& residuals) {
  double sum = 0;
  for (const double r : residuals) sum += r * r;
  return sum / static_cast<double>(residuals.size());
}

/// What the optimiser calls; it is written in C, so that exceptions wait here until it has returned.
struct Search {
  const Residuals& residuals;
  const std::function<void(int, double)>& follow;
  nlopt_opt optimiser;
  Calibration found;
  std::exception_ptr thrown;

  double mean_square(const std::vector<double>& at) {
    const auto there = residuals(at);
    ++found.num_evaluations;
    if (!there) ++found.num_failed;
    const double value = there ? mean_square_of(*there) : kNoResult * kNoResult;
    if (there && (found.best.empty() || value < found.mean_square)) {
      found.best = at;
      found.mean_square = value;
    }
    follow(found.num_evaluations, std::sqrt(found.mean_square));
    return value;
  }

  static double call(unsigned size, const double* at, double*, void* self) {
    Search& search = *static_cast<Search*>(self);
    try {
      return search.mean_square({at, at + size});
    } catch (...) {
      search.thrown = std::current_exception();
      nlopt_force_stop(search.optimiser);
      return kNoResult * kNoResult;
    }
  }
};

}  // namespace

Calibration calibrate(const Residuals& residuals, const std::vector<double>& start, int most_evaluations,
                      const std::function<void(int, double)>& follow) {
  // BOBYQA follows the curved valleys of correlated parameters with few evaluations, but needs two parameters
  const nlopt_algorithm algorithm = start.size() > 1 ? NLOPT_LN_BOBYQA : NLOPT_LN_SBPLX;
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser(
      nlopt_create(algorithm, static_cast<unsigned>(start.size())), nlopt_destroy);
  if (!optimiser) throw std::bad_alloc();

  Search search{residuals, follow, optimiser.get(), {}, {}};
  nlopt_set_min_objective(optimiser.get(), Search::call, &search);
  nlopt_set_lower_bounds1(optimiser.get(), 0);
  nlopt_set_upper_bounds1(optimiser.get(), 1);
  nlopt_set_initial_step1(optimiser.get(), kFirstStep);
  nlopt_set_xtol_abs1(optimiser.get(), kEnough);
  nlopt_set_stopval(optimiser.get(), kPerfect * kPerfect);
  nlopt_set_maxeval(optimiser.get(), most_evaluations);

  std::vector<double> at = start;
  double least = 0;
  const nlopt_result result = nlopt_optimize(optimiser.get(), at.data(), &least);
  if (search.thrown) std::rethrow_exception(search.thrown);
  // where rounding leaves no better step, what was found is the best there is
  search.found.is_converged = result == NLOPT_SUCCESS || result == NLOPT_STOPVAL_REACHED ||
                              result == NLOPT_FTOL_REACHED || result == NLOPT_XTOL_REACHED ||
                              result == NLOPT_ROUNDOFF_LIMITED;
  return search.found;
}

std::vector<Uncertainty> uncertainties(const Residuals& residuals, const std::vector<double>& at, double distance) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const auto size = static_cast<Eigen::Index>(at.size());
  const std::optional<std::vector<double>> here = residuals(at);
  if (!here) return std::vector<Uncertainty>(at.size(), {kInfinite, kInfinite});
  const auto vector = [](const std::vector<double>& r) {
    return Eigen::Map<const Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
  };

  // slopes of the residuals per length of the box, from both sides where both lie within it and have results
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(here->size()), size);
  for (Eigen::Index p = 0; p < size; ++p) {
    std::optional<std::vector<double>> side[2];
    double place[2];
    for (const int k : {0, 1}) {
      std::vector<double> moved = at;
      double& parameter = moved[static_cast<std::size_t>(p)];
      parameter = std::clamp(parameter + (k == 0 ? -kSlopeStep : kSlopeStep), 0.0, 1.0);
      place[k] = parameter;
      side[k] = parameter == at[static_cast<std::size_t>(p)] ? here : residuals(moved);
      if (!side[k]) {
        side[k] = here;
        place[k] = at[static_cast<std::size_t>(p)];
      }
    }
    if (place[1] > place[0]) J.col(p) = (vector(*side[1]) - vector(*side[0])) / (place[1] - place[0]);
  }

  const double reach = distance * std::sqrt(static_cast<double>(here->size()));
  std::vector<Uncertainty> found;
  for (Eigen::Index p = 0; p < size; ++p) {
    // what is left of a column when the others have done what they can; the direction of one that is rounding says
    // nothing
    Eigen::VectorXd rest = J.col(p);
    std::vector<Eigen::Index> others;
    for (Eigen::Index q = 0; q < size; ++q)
      if (q != p && J.col(q).norm() > kNoSlope) others.push_back(q);
    if (!others.empty()) {
      const Eigen::MatrixXd theirs = J(Eigen::all, others);
      rest -= theirs * theirs.colPivHouseholderQr().solve(J.col(p));
    }
    const auto uncertainty = [&](const Eigen::VectorXd& slope) {
      return slope.norm() > kNoSlope ? reach / slope.norm() : kInfinite;
    };
    found.push_back({uncertainty(J.col(p)), uncertainty(rest)});
  }
  return found;
}

}  // namespace hexaplast::runner
