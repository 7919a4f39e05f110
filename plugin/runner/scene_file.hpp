// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/interfaces.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// Reads and initialises a scene; plugins are looked for in `plugin_path`, then in the installation. An override is
/// PATH.attribute=VALUE. Logs the scene's warnings. Throws what reading a scene throws (scene/reader.hpp).
scene::Scene load_scene(const std::filesystem::path& file, const std::vector<std::filesystem::path>& plugin_path,
                        const std::vector<std::string>& overrides);

/// The parts of a scene that the command works on. Throw SceneError unless there is exactly one.
scene::MechanicalState& only_state(scene::Scene& scene);
scene::OdeSolver& only_solver(scene::Scene& scene);

/// The force field that has a body; null: there is none. Throws SceneError where there are two.
const scene::ForceField* find_body(scene::Scene& scene);

/// The scene's RunSettings; null: there are none.
scene::Component* find_settings(scene::Scene& scene);

}  // namespace hexaplast::runner
