// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace hexaplast::parts {

/// In scenes: AttributeChange.values. The texts between semicolons, without blanks around them; none for a blank one.
std::vector<std::optional<std::string_view>> values_of_changes(std::string_view text);

}  // namespace hexaplast::parts
