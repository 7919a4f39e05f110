// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/key_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "parts/option.hpp"

namespace hexaplast::parts {

// A sum of n steps is wrong by n/2 units in the last place at most: this serves runs of a million steps.
bool has_come(double moment, double time) {
  constexpr double kRounding = 1e-10;
  return time >= moment - kRounding * std::abs(moment);
}

std::ptrdiff_t num_come(std::span<const double> times, double time) {
  return std::ranges::partition_point(times, [&](double moment) { return has_come(moment, time); }) - times.begin();
}

void check_key_times(std::string_view option, std::span<const double> times, std::string_view values,
                     std::size_t num_values) {
  if (times.empty()) throw OptionError(option, "is empty, must hold at least one time");
  if (times.size() != num_values)
    throw OptionError(values,
                      fmt::format("{} {} given for {} times, must be as many", num_values, values, times.size()));
  const auto fault = std::adjacent_find(times.begin(), times.end(), std::greater_equal<>());
  if (fault != times.end())
    throw OptionError(option, fmt::format("{} is followed by {}, must be ascending", fault[0], fault[1]));
}

}  // namespace hexaplast::parts
