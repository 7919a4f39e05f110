// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "attributes/attribute.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

using Descriptions = std::vector<const attributes::Description*>;

/// What scenes may name, with the plugins of the options. Throws scene::PluginError.
Descriptions known_components(const SceneOptions& options = {});

/// Descriptions of one category.
struct ComponentGroup {
  std::string_view category;
  Descriptions components;
};

/// The components that do something, by category, in the order in which a scene needs them; names ascend within each.
std::vector<ComponentGroup> grouped(const Descriptions& components);

/// The documentation page of all components, in Markdown.
std::string component_page(const Descriptions& components);

}  // namespace hexaplast::runner
