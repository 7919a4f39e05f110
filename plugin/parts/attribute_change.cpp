// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/attribute_change.hpp"

namespace hexaplast::parts {

std::vector<std::optional<std::string_view>> values_of_changes(std::string_view text) {
  std::vector<std::optional<std::string_view>> values;
  if (text.empty()) return values;
  for (;;) {
    const std::size_t end = text.find(';');
    const std::string_view one = text.substr(0, end);
    const bool is_blank = one.find_first_not_of(" \t\n\r") == one.npos;
    values.push_back(is_blank ? std::nullopt : std::optional(one));
    if (end == text.npos) return values;
    text.remove_prefix(end + 1);
  }
}

}  // namespace hexaplast::parts
