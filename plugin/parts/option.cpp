// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/option.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "attributes/words.hpp"

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
    : InputError(fmt::format("{}: {}", option, reason)), reasons_{{attribute_name(option), reason}} {}

bool OptionErrors::accepts(std::string_view option) const {
  return std::ranges::count(reasons_, attribute_name(option), &Remark::attribute) == 0;
}

void OptionErrors::add(const OptionError& error) {
  if (!accepts(error.reasons().front().attribute)) return;
  what_ += fmt::format("{}{}", what_.empty() ? "" : "\n", error.what());
  reasons_.insert(reasons_.end(), error.reasons().begin(), error.reasons().end());
}

void OptionErrors::throw_all() const {
  if (!empty()) throw OptionError(what_, reasons_);
}

void OptionRanges::check_numbers(std::string_view option, std::span<const double> numbers) {
  const attributes::Range& range = attributes::attribute_of(table_, attribute_name(option)).range;
  collect([&] {
    for (const double number : numbers) check_range(option, range, number);
  });
}

void OptionRanges::check_numbers(std::string_view option, std::span<const int> numbers) {
  const attributes::Range& range = attributes::attribute_of(table_, attribute_name(option)).range;
  if (range == attributes::kIndex) return;  // by whoever knows how many there are
  collect([&] {
    for (const int number : numbers) check_range(option, range, number);
  });
}

void check_range(std::string_view option, const attributes::Range& range, double number) {
  if (!std::isfinite(number)) throw OptionError(option, fmt::format("{} is not finite", number));
  if (!range.contains(number)) throw OptionError(option, attributes::inadmissible(range, number));
}

void check_nodes(std::string_view option, std::span<const int> nodes, int num_nodes) {
  for (const int node : nodes)
    if (node < 0 || node >= num_nodes)
      throw OptionError(option, fmt::format("{} must lie in [0, {})", node, num_nodes));
}

void check_word(std::string_view option, std::span<const std::string_view> words, std::string_view word) {
  if (const std::string error = attributes::unknown_word(word, words); !error.empty()) throw OptionError(option, error);
}

std::size_t place_of_word(const attributes::Attribute& attribute, std::string_view word) {
  const std::vector<std::string_view> words = attributes::split_words(attribute.words);
  check_word(attribute.name, words, word);
  return static_cast<std::size_t>(std::ranges::find(words, word) - words.begin());
}

}  // namespace hexaplast::parts
