// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/key_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace hexaplast::components {

std::vector<double> key_times(scene::Object& owner, std::string_view times, std::string_view values,
                              std::size_t num_values) {
  const std::vector<double>& keys = owner.reals(times);
  if (keys.empty()) owner.reject(times, "is empty, must hold at least one time");
  if (keys.size() != num_values)
    owner.reject(values, fmt::format("{} {} given for {} times, must be as many", num_values, values, keys.size()));
  const auto fault = std::adjacent_find(keys.begin(), keys.end(), std::greater_equal<>());
  if (fault != keys.end())
    owner.reject(times, fmt::format("{} is followed by {}, must be ascending", fault[0], fault[1]));
  return keys;
}

}  // namespace hexaplast::components
