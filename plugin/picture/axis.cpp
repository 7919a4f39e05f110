// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hexaplast::output {
namespace {

constexpr int kMaxDecimals = 4;  // longer fractions are harder to read than exponents
constexpr double kLargestPlain = 1e5;

/// The smallest of 1, 2, 5 times a power of ten that is not less than `step`.
double round_up(double step) {
  const double power = std::pow(10, std::floor(std::log10(step)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= step * (1 - 1e-9)) return digit * power;
  return 10 * power;
}

Ticks multiples(double min, double max, double step) {
  constexpr double kSlack = 1e-6;  // of a step: an end that is a multiple but for rounding counts
  Ticks ticks{.min = min, .max = max, .values = {}, .decimals = 0};
  const double first = std::ceil(min / step - kSlack), last = std::floor(max / step + kSlack);
  for (double k = first; k <= last; ++k) ticks.values.push_back(k * step);

  ticks.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + kSlack)));
  if (ticks.decimals > kMaxDecimals || std::max(std::abs(min), std::abs(max)) >= kLargestPlain) ticks.decimals = -1;
  return ticks;
}

}  // namespace

std::string Ticks::label(double value) const {
  if (value == 0) return "0";
  return decimals < 0 ? fmt::format("{:.3g}", value) : fmt::format("{:.{}f}", value, decimals);
}

Ticks ticks_within(double min, double max, int count) {
  double step = round_up((max - min) / count);
  Ticks ticks = multiples(min, max, step);
  // from 6 to 14 there is one multiple of 5: a scale takes two numbers to be one
  while (ticks.values.size() < 2) {
    step = round_up(step / 3);  // the next smaller one of 1, 2, 5
    ticks = multiples(min, max, step);
  }
  return ticks;
}

std::vector<std::pair<double, std::string>> labels_of_scale(double min, double max, int count) {
  constexpr double kHalfLetter = 0.0115;  // of the scale: half of the width of a letter, and of the room between labels
  const auto end = [](double value) { return std::pair(value, fmt::format("{:.3g}", value)); };
  const auto is_apart = [&](double value, const std::string& label, const std::pair<double, std::string>& other) {
    return std::abs(value - other.first) >
           kHalfLetter * static_cast<double>(label.size() + other.second.size()) * (max - min);
  };
  std::vector labels{end(min)};
  const auto last = end(max);
  const Ticks ticks = ticks_within(min, max, count);
  for (const double value : ticks.values)
    if (std::string label = ticks.label(value); is_apart(value, label, labels.front()) && is_apart(value, label, last))
      labels.emplace_back(value, std::move(label));
  labels.push_back(last);
  return labels;
}

Ticks ticks_around(double min, double max, int count) {
  constexpr double kOverhang = 0.02;  // of a step: so little may stand out rather than open another step
  const double step = round_up((max - min) / count);
  return multiples(std::floor(min / step + kOverhang) * step, std::ceil(max / step - kOverhang) * step, step);
}

}  // namespace hexaplast::output
