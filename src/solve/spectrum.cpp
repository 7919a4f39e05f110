// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/spectrum.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "hexaplast/layout/linear_system.hpp"

namespace hexaplast {

bool SpectralRadii::is_valid_for(const SpectralRadii& other) const {
  const auto is_near = [](double sum, double other_sum) {
    return std::abs(sum - other_sum) <= kMaxChangeOfRadii * other_sum;
  };
  return num_levels == other.num_levels && num_solves < kMaxSolvesOfRadii && factor == other.factor &&
         num_free == other.num_free && is_near(diagonal, other.diagonal) && is_near(stiffness, other.stiffness);
}

void SpectralRadii::update(int iterations_now) {
  if (num_levels == 0) return;
  if (num_solves == 1) iterations = iterations_now;
  if (iterations_now > kMaxGrowthOfIterations * iterations + 1) num_solves = kMaxSolvesOfRadii;
}

bool SolverMemory::is_valid() const {
  return std::ranges::all_of(radii, [](const SpectralRadii& of_body) { return of_body.is_valid(); });
}

bool SpectralRadii::is_valid() const {
  return num_levels >= 0 && num_levels <= kMaxLevels && num_solves >= 0 &&
         std::all_of(of_level.begin(), of_level.begin() + num_levels,
                     [](double radius) { return radius > 0 && std::isfinite(radius); });
}

namespace {

/// What Lanczos has found of a matrix: tridiagonal, of a size that needs no allocation.
struct Tridiagonal {
  template <int kRows, int kMaxRows>
  using Column = Eigen::Matrix<double, kRows, 1, 0, kMaxRows, 1>;
  Column<kMaxLanczosSteps, kMaxLanczosSteps> diagonal = decltype(diagonal)::Zero(), beside = diagonal;

  /// Of the first `size` rows.
  double largest_eigenvalue(int size) const {
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxLanczosSteps, kMaxLanczosSteps>;
    Eigen::SelfAdjointEigenSolver<Matrix> solver(size);
    solver.computeFromTridiagonal(Column<Eigen::Dynamic, kMaxLanczosSteps>(diagonal.head(size)),
                                  Column<Eigen::Dynamic, kMaxLanczosSteps - 1>(beside.head(size - 1)),
                                  Eigen::EigenvaluesOnly);
    return solver.eigenvalues()[size - 1];
  }
};

}  // namespace

double largest_eigenvalue(LanczosSpace& space, int min_steps) {
  Tridiagonal found;
  auto &alpha = found.diagonal, &beta = found.beside;
  double largest = 0, norm = std::sqrt(space.start());
  for (int step = 0;; ++step) {
    if (step > 0) beta[step - 1] = norm;
    if (step == kMaxLanczosSteps || !(norm > kRangeEnds * alpha[0])) break;

    alpha[step] = space.multiply(1 / norm);
    const double before_step = std::exchange(largest, found.largest_eigenvalue(step + 1));
    if (step + 1 >= min_steps && !(largest > kLanczosGrowth * before_step)) break;
    norm = std::sqrt(space.advance(alpha[step], step > 0 ? norm : 0));
  }
  return largest > 0 ? largest : 1;
}

}  // namespace hexaplast
