// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "hexaplast/formats/text.hpp"

namespace hexaplast::scene {
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

std::string format(const Message& message) {
  static constexpr std::string_view kWords[] = {"note", "warning", "error"};
  // names and values are a stranger's: the lines are ours
  std::string line = printable_line(message.place.file);
  if (message.place.line > 0) line += fmt::format(":{}", message.place.line);

  line += fmt::format(": {}: {}", kWords[static_cast<int>(message.severity)], printable_line(message.text));
  for (const Place* at = message.place.included_at.get(); at; at = at->included_at.get())
    line += fmt::format("\n  included at {}:{}", printable_line(at->file), at->line);
  if (!message.hint.empty()) line += "\n  hint: " + printable_line(message.hint);
  return line;
}

std::string format_error(const Place& place, const std::string& text, const std::string& hint) {
  Message message;
  message.place = place;
  message.text = text;
  message.hint = hint;
  return format(message);
}

void Diagnostics::add(Message message) {
  if (message.severity != Severity::kError) {
    warnings_.push_back(std::move(message));
    return;
  }
  is_scene_at_fault_ |= message.fault == Fault::kScene;
  if (++num_errors_ <= kMostErrors) {
    errors_.push_back(std::move(message));
  } else if (num_errors_ >= kMostCounted) {
    throw_errors();
  }
}

void Diagnostics::throw_errors() const {
  if (!has_errors()) return;

  std::string all;
  for (const Message& error : errors_) {
    if (!all.empty()) all += '\n';
    all += format(error);
  }
  if (num_errors_ > kMostErrors)
    all += fmt::format("\n{}{} further errors are not shown", num_errors_ >= kMostCounted ? "at least " : "",
                       num_errors_ - kMostErrors);
  if (!is_scene_at_fault_) throw FileError(all);
  throw SceneError(all);
}

std::vector<Message> Diagnostics::take_warnings() { return std::exchange(warnings_, {}); }

std::string nearest(std::string_view name, const std::vector<std::string_view>& names) {
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

std::string did_you_mean(std::string_view name, const std::vector<std::string_view>& names) {
  const std::string candidate = nearest(name, names);
  return candidate.empty() ? std::string() : fmt::format("did you mean '{}'?", candidate);
}

}  // namespace hexaplast::scene
