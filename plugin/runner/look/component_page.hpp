// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "attributes/attribute.hpp"

namespace hexaplast::runner {

/// Descriptions of one category.
struct ComponentGroup {
  std::string_view category;
  std::vector<const attributes::Description*> components;
};

/// The components that do something, by category, in the order in which a scene needs them; names ascend within each.
std::vector<ComponentGroup> grouped(const std::vector<const attributes::Description*>& components);

/// Who writes an attribute: "input", "output", "state" or "ignored".
std::string_view describe(attributes::Access access);

/// The documentation page of all components, in Markdown.
std::string component_page(const std::vector<const attributes::Description*>& components);

}  // namespace hexaplast::runner
