// SPDX-License-Identifier: LGPL-2.1-or-later
#include "attributes/words.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "hexaplast/base/rows.hpp"

namespace hexaplast::attributes {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

// Optimal string alignment: Levenshtein's distance with swaps of neighbours.
int edits(std::string_view a, std::string_view b) {
  std::vector<std::vector<int>> cost(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = static_cast<int>(i);
  for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = static_cast<int>(j);

  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int replaced = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      cost[i][j] = std::min({replaced, cost[i - 1][j] + 1, cost[i][j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

}  // namespace

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words;
  for_each_word(text, [&](std::string_view word) { words.push_back(word); });
  return words;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 40;
  return fmt::format("'{}{}'", text.substr(0, kShown), text.size() > kShown ? "..." : "");
}

std::string nearest(std::string_view name, std::span<const std::string_view> names) {
  constexpr std::size_t kLongestName = 100;  // longer ones are no misspellings, and the table of edits grows with them
  if (name.empty() || name.size() > kLongestName) return {};

  std::string_view best;
  int fewest = 3;
  for (const std::string_view candidate : names) {
    const int count = lower(name) == lower(candidate) ? 0 : edits(name, candidate);
    if (count < fewest && 2 * count < static_cast<int>(std::max(name.size(), candidate.size()))) {
      best = candidate;
      fewest = count;
    }
  }
  return std::string(best);
}

std::string unknown_word(std::string_view word, std::span<const std::string_view> words) {
  if (std::ranges::count(words, word) > 0) return {};
  const std::string candidate = nearest(word, words);
  return fmt::format("{} must be {}{}", quoted(word), alternatives(words),
                     candidate.empty() ? "" : fmt::format(" (did you mean '{}'?)", candidate));
}

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
