// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "attributes/attribute.hpp"

/// Words in the values of attributes, what a wrong one was meant to be, and numbers that cannot be.
namespace hexaplast::attributes {

/// Calls with each word of a text, which blanks separate.
template <class Visit>
void for_each_word(std::string_view text, const Visit& visit) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::size_t at = text.find_first_not_of(kBlanks);
  while (at != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    visit(text.substr(at, end - at));
    at = text.find_first_not_of(kBlanks, end);
  }
}

/// The words of a text, without copying it.
std::vector<std::string_view> split_words(std::string_view text);

/// "'text'", of a long one the beginning.
std::string quoted(std::string_view text);

/// The one of `names` that `name` probably means: equal but for case, or at most two edits (insert, delete, replace,
/// swap of neighbours) away, and nearer than half its length. Empty when there is none.
std::string nearest(std::string_view name, std::span<const std::string_view> names);

/// "must be > 0", "must lie in [0, 0.5)"; empty when every number is admissible.
std::string describe(const Range& range);

/// "-1 must be > 0": what is wrong with a number that a range does not contain.
std::string inadmissible(const Range& range, double number);
std::string inadmissible(const Range& range, long number);

/// "'vonMiss' must be vonMises or frobenius (did you mean 'vonMises'?)"; empty where `word` is one of `words`.
std::string unknown_word(std::string_view word, std::span<const std::string_view> words);

}  // namespace hexaplast::attributes
