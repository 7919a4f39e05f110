// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hexaplast {

/// Bytes in base64 (RFC 4648), padded.
std::string to_base64(std::string_view bytes);

/// What text in base64 stands for, a zero byte in place of each byte that its padding leaves out; nothing where it
/// holds another character. Its size is a multiple of four.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace hexaplast
