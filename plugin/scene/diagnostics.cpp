// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "formats/text.hpp"

namespace hexaplast::scene {

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
  return format({.place = place, .text = text, .hint = hint});
}

void Diagnostics::add(Message message) {
  if (message.severity != Severity::kError) {
    warnings_.push_back(std::move(message));
    return;
  }
  if (++num_errors_ <= kMaxErrors) {
    errors_.push_back(std::move(message));
  } else if (num_errors_ >= kMaxCounted) {
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
  if (num_errors_ > kMaxErrors)
    all += fmt::format("\n{}{} further errors are not shown", num_errors_ >= kMaxCounted ? "at least " : "",
                       num_errors_ - kMaxErrors);
  throw SceneError(all);
}

std::vector<Message> Diagnostics::take_warnings() { return std::exchange(warnings_, {}); }

std::string did_you_mean(std::string_view name, const std::vector<std::string_view>& names) {
  const std::string candidate = nearest(name, names);
  return candidate.empty() ? std::string() : fmt::format("did you mean '{}'?", candidate);
}

}  // namespace hexaplast::scene
