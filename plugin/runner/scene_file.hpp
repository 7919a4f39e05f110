// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/interfaces.hpp"
#include "scene/plugin.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// The scene of a command, as the command line gives it.
struct SceneOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;              ///< PATH.attribute=VALUE
  std::vector<std::string> plugins;                ///< names of plugins to load before the scene is read
  std::vector<std::filesystem::path> plugin_path;  ///< where plugins are looked for before the installation
  bool sofa_compat = false;                        ///< pass over what is unknown, as SOFA does
};

/// Loads our own components and the named plugins into a factory. Throws PluginError.
scene::PluginLoader load_components(scene::Factory& factory, const std::vector<std::string>& plugins,
                                    const std::vector<std::filesystem::path>& plugin_path);

/// Reads and initialises a scene, and logs its warnings. Throws what reading a scene throws (scene/reader.hpp).
scene::Scene load_scene(const SceneOptions& options);

/// Logs what components have remarked since the last time.
void log_warnings(scene::Scene& scene);

/// The parts of a scene that the command works on. Throw SceneError unless there is exactly one.
scene::MechanicalState& only_state(scene::Scene& scene);
scene::OdeSolver& only_solver(scene::Scene& scene);

/// The force field that has a body; null: there is none. Throws SceneError where there are two.
const scene::ForceField* find_body(scene::Scene& scene);

/// The scene's RunSettings; null: there are none.
scene::Component* find_settings(scene::Scene& scene);

}  // namespace hexaplast::runner
