// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hexaplast {

/// Bytes of the UTF-8 sequence that begins at `at`; 0 when it is not well-formed (overlong, surrogate, beyond U+10FFFF,
/// cut off).
std::size_t utf8_length(std::string_view text, std::size_t at);

/// The number of the character of well-formed UTF-8.
unsigned code_point(std::string_view character);

/// Text as a terminal may be shown it: what is no character to be seen (escape and all other control characters but
/// line ends and tabs, delete, marks that turn the direction of writing) becomes a backslash, u and its number; bytes
/// that are no UTF-8 a backslash, x and theirs. All else stays as it is.
std::string printable(std::string_view text);

/// The same of what stands in one line, such as the name of a file: line ends and tabs too.
std::string printable_line(std::string_view text);

/// The beginning of a text as printable_line, "..." where more of it follows: what a message repeats of a file.
std::string excerpt(std::string_view text);

/// Whether a file name is prefix, digits, suffix.
bool is_numbered(std::string_view name, std::string_view prefix, std::string_view suffix);

}  // namespace hexaplast
