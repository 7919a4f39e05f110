// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string_view>
#include <vector>

#include "hexaplast/base/archive.hpp"

namespace hexaplast {

/// A kind of state in streams:
///
///   bytes | content, little-endian
///       8 | magic
///       4 | version
///       8 | identity of what the contents belong to
///       8 | size of what follows
///       n | contents
///       8 | XXH64 of all bytes before
struct SavedKind {
  std::array<char, 8> magic;
  std::uint32_t version;
  std::string_view name;  ///< for messages: "body"
};

/// Throws InputError when the stream does not take it all.
void write_saved(std::ostream& out, const SavedKind& kind, std::uint64_t identity,
                 const std::function<void(Archive&)>& contents);

/// The contents; reads no byte beyond. Throws InputError for what is damaged, of more than `max` bytes, or of another
/// kind, version or identity.
std::vector<std::byte> read_saved(std::istream& in, const SavedKind& kind, std::uint64_t identity, std::size_t max);

}  // namespace hexaplast
