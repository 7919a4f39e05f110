// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hexaplast::runner {

/// An attribute that is varied, and the values that it takes.
struct Factor {
  std::string attribute;            ///< PATH.attribute
  std::vector<std::string> values;  ///< as a scene would write them, all different; at least one
  std::vector<double> numbers;      ///< the values, where all of them are numbers; otherwise empty
  bool is_logarithmic = false;      ///< equal factors lie between neighbours

  bool operator==(const Factor& other) const { return attribute == other.attribute && values == other.values; }
};

/// A factor with these values; finds their numbers. Throws UsageError where a value is empty or comes twice; `whole`
/// begins its message.
Factor factor_of(std::string attribute, std::vector<std::string> values, bool is_logarithmic, std::string_view whole);

/// Reads PATH.attribute=a:b:n (n values from a to b, at equal distances), a:b:n:log (in equal factors) or v1,v2,...;
/// computed values are rounded to twelve digits. Throws UsageError.
Factor parse_factor(std::string_view text);

/// The parts of a text between separators; one more than there are separators.
std::vector<std::string_view> split(std::string_view text, char separator);

/// A number as scenes write it; throws UsageError, which begins with `whole`.
double parse_number(std::string_view text, std::string_view whole);

}  // namespace hexaplast::runner
