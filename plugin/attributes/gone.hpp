// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <string_view>

/// Names that scenes could have in earlier versions, and what to write instead: what the errors of such a scene say.
namespace hexaplast::attributes {

/// What to write instead of a component, CLASS.attribute, or .attribute of any class (gone.names).
const std::multimap<std::string_view, std::string_view>& gone();

/// The same of one name; empty: there never was one.
std::string_view instead_of(std::string_view name);

}  // namespace hexaplast::attributes
