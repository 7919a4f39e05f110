// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/parts.hpp"
#include "scene/plugin.hpp"

namespace hexaplast::runner {

/// The scene of a command, as the command line gives it.
struct SceneOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;              ///< PATH.attribute=VALUE
  std::vector<std::string> plugins;                ///< names of plugins to load before the scene is read
  std::vector<std::filesystem::path> plugin_path;  ///< where plugins are looked for before the installation
  std::vector<std::filesystem::path> mesh_path;    ///< where meshes and includes are looked for besides
  std::filesystem::path untrusted;                 ///< folder below which plugin_path leads to nothing; empty: none
};

/// Loads our own components and the named plugins into a factory. Throws PluginError.
scene::PluginLoader load_components(scene::Factory& factory, const SceneOptions& options = {});

/// Reads a scene, replaces the attributes, without init. A scene with mistakes is left as read: init throws them.
/// Throws what reading a scene throws (scene/reader.hpp).
scene::Scene read_scene(const SceneOptions& options);

/// Reads and initialises a scene, and logs its warnings. Throws what reading a scene throws (scene/reader.hpp).
scene::Scene load_scene(const SceneOptions& options);

/// Logs what components have remarked since the last time.
void log_warnings(scene::Scene& scene);

using scene::probes_of, scene::find_body, scene::find_settings;

}  // namespace hexaplast::runner
