// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// `hexaplast list`, as the command line gives it.
struct ListOptions {
  std::optional<std::string> component;  ///< all of them where it is not given
  bool json = false;
  bool markdown = false;  ///< the page docs/components.md
  std::vector<std::string> plugins;
  std::vector<std::filesystem::path> plugin_path;
};

/// Prints what scenes may name and what it takes, from the attribute table. Throws UsageError for an unknown component,
/// scene::PluginError.
void list(const ListOptions& options);

/// What `list` takes as a name, without plugins of the user's. Throws scene::PluginError.
std::vector<std::string> component_names();

}  // namespace hexaplast::runner
