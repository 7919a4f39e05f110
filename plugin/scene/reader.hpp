// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scene/factory.hpp"
#include "scene/plugin.hpp"
#include "scene/scene.hpp"

namespace hexaplast::scene {

/// The scene file is missing or cannot be read.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr std::uintmax_t kLargestSceneFile = 64 * 1024 * 1024;  // [byte]; larger meshes belong into mesh files

/// Reads a scene file in SOFA's XML grammar, strictly. Plugins that it requires are loaded at once.
///
/// One root element, a Node; nodes hold nodes and components (`<Class/>` or `<Object type="Class"/>`). Attributes whose
/// name begins with `_` or `NO` are switched off. UTF-8; no document type, no entities but XML's five, at most 100
/// levels. Mistakes are collected in the scene's diagnostics: call init() to have them thrown together. Throws
/// FileError, PluginError, and SceneError for a file that is not well-formed.
Scene read_scene(const std::filesystem::path& file, const Factory& factory, PluginLoader& plugins);

/// The same from text; `name` stands for the file in messages.
Scene read_scene_text(std::string_view text, const std::string& name, const Factory& factory, PluginLoader& plugins);

/// The command line's `--set PATH.attribute=VALUE` does not fit the scene.
class OverrideError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Replaces an attribute between reading and init: "bar/material.yieldStress=500", "root.dt=0.005". PATH is a link path
/// from the root, which may be named itself. Throws OverrideError.
void override_attribute(Scene& scene, std::string_view assignment);

}  // namespace hexaplast::scene
