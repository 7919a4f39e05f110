// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/admissible.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hexaplast::attributes {

std::string describe(const Range& range) {
  const bool below = std::isfinite(range.min), above = std::isfinite(range.max);
  if (below && above)
    return fmt::format("must lie in {}{:.10g}, {:.10g}{}", range.exclusive_min ? '(' : '[', range.min, range.max,
                       range.exclusive_max ? ')' : ']');
  if (below) return fmt::format("must be {} {:.10g}", range.exclusive_min ? ">" : ">=", range.min);
  if (above) return fmt::format("must be {} {:.10g}", range.exclusive_max ? "<" : "<=", range.max);
  return {};
}

std::string inadmissible(const Range& range, double number) { return fmt::format("{} {}", number, describe(range)); }
std::string inadmissible(const Range& range, long number) { return fmt::format("{} {}", number, describe(range)); }

}  // namespace hexaplast::attributes
