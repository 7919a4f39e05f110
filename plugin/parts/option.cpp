// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/option.hpp"

#include <fmt/format.h>

#include <cmath>

#include "attributes/admissible.hpp"

namespace hexaplast::parts {

std::string attribute_name(std::string_view option) {
  std::string name;
  bool is_behind_underscore = false;
  for (const char letter : option) {
    if (letter != '_')
      name += is_behind_underscore && letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
    is_behind_underscore = letter == '_';
  }
  return name;
}

OptionError::OptionError(std::string_view option, const std::string& reason)
    : InputError(fmt::format("{}: {}", option, reason)), attribute_(attribute_name(option)), reason_(reason) {}

template <class Number>
void OptionRanges::check_each(std::string_view option, std::span<const Number> numbers) const {
  const attributes::Attribute& attribute = attributes::attribute_of(table_, attribute_name(option));
  for (const Number number : numbers) {
    if (!std::isfinite(static_cast<double>(number))) throw OptionError(option, fmt::format("{} is not finite", number));
    if (!attribute.range.contains(static_cast<double>(number)))
      throw OptionError(option, attributes::inadmissible(attribute.range, number));
  }
}

void OptionRanges::check(std::string_view option, double number) const {
  check_each<double>(option, std::span(&number, 1));
}
void OptionRanges::check(std::string_view option, int number) const { check_each<int>(option, std::span(&number, 1)); }
void OptionRanges::check(std::string_view option, std::span<const double> numbers) const {
  check_each(option, numbers);
}
void OptionRanges::check(std::string_view option, std::span<const int> numbers) const { check_each(option, numbers); }

void check_nodes(std::string_view option, std::span<const int> nodes, int num_nodes) {
  for (const int node : nodes)
    if (node < 0 || node >= num_nodes)
      throw OptionError(option, fmt::format("{} must lie in [0, {})", node, num_nodes));
}

}  // namespace hexaplast::parts
