// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "attributes/attribute.hpp"

namespace hexaplast::attributes {

/// "must be > 0", "must lie in [0, 0.5)"; empty when every number is admissible.
inline std::string describe(const Range& range) {
  const bool below = std::isfinite(range.min), above = std::isfinite(range.max);
  if (below && above) {
    return fmt::format("must lie in {}{:.10g}, {:.10g}{}", range.exclusive_min ? '(' : '[', range.min, range.max,
                       range.exclusive_max ? ')' : ']');
  }
  if (below) return fmt::format("must be {} {:.10g}", range.exclusive_min ? ">" : ">=", range.min);
  if (above) return fmt::format("must be {} {:.10g}", range.exclusive_max ? "<" : "<=", range.max);
  return {};
}

/// "-1 must be > 0": what is wrong with a number that a range does not contain.
template <class Number>
std::string inadmissible(const Range& range, Number number) {
  return fmt::format("{} {}", number, describe(range));
}

}  // namespace hexaplast::attributes
