// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formats/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace hexaplast {

std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u; };
  const auto continues = [&](std::size_t i) { return (byte(i) & 0xC0) == 0x80; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return continues(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    const unsigned min = first == 0xE0 ? 0xA0 : 0x80, max = first == 0xED ? 0x9F : 0xBF;
    return byte(1) >= min && byte(1) <= max && continues(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned min = first == 0xF0 ? 0x90 : 0x80, max = first == 0xF4 ? 0x8F : 0xBF;
    return byte(1) >= min && byte(1) <= max && continues(2) && continues(3) ? 4 : 0;
  }
  return 0;
}

unsigned code_point(std::string_view character) {
  const unsigned first = static_cast<unsigned char>(character[0]);
  unsigned code = character.size() == 1 ? first : first & (0x7Fu >> character.size());
  for (const char c : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(c) & 0x3Fu);
  return code;
}

namespace {

/// Control characters, ends of lines, and marks that turn the direction of writing.
bool is_unseen(unsigned code) {
  return code < 0x20 || (code >= 0x7F && code <= 0x9F) || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

std::string shown_but(std::string_view text, std::string_view layout) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const std::string_view character = text.substr(at, std::max<std::size_t>(length, 1));
    if (length == 0)
      fmt::format_to(std::back_inserter(shown), "\\x{:02x}", static_cast<unsigned char>(character[0]));
    else if (layout.find(character) == layout.npos && is_unseen(code_point(character)))
      fmt::format_to(std::back_inserter(shown), "\\u{:04x}", code_point(character));
    else
      shown += character;
    at += character.size();
  }
  return shown;
}

}  // namespace

std::string printable(std::string_view text) { return shown_but(text, "\n\t"); }

std::string printable_line(std::string_view text) { return shown_but(text, ""); }

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;  // [byte]
  return printable_line(text.substr(0, kLongest)) + (text.size() > kLongest ? "..." : "");
}

bool is_numbered(std::string_view name, std::string_view prefix, std::string_view suffix) {
  if (!name.starts_with(prefix) || !name.ends_with(suffix) || name.size() <= prefix.size() + suffix.size())
    return false;
  const std::string_view digits = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
  return std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace hexaplast
