// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/attribute_change.hpp"

namespace hexaplast::parts {

constexpr std::string_view kBlanks = " \t\n\r";

std::vector<std::optional<std::string_view>> values_of_changes(std::string_view text) {
  std::vector<std::optional<std::string_view>> values;
  for (;;) {
    const std::size_t end = text.find(';');
    const std::string_view one = text.substr(0, end);
    const std::size_t first = one.find_first_not_of(kBlanks);
    if (first == one.npos)
      values.emplace_back();
    else
      values.emplace_back(one.substr(first, one.find_last_not_of(kBlanks) + 1 - first));
    if (end == text.npos) return values;
    text.remove_prefix(end + 1);
  }
}

}  // namespace hexaplast::parts
