// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material/relaxation.hpp"

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

}  // namespace hexaplast
