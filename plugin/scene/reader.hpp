// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scene/document.hpp"
#include "scene/factory.hpp"
#include "scene/plugin.hpp"
#include "scene/scene.hpp"

namespace hexaplast::scene {

/// Throws FileError with the reason where a file cannot be read.
void require_readable(const std::filesystem::path& file);

/// Reads a scene file in SOFA's XML grammar (document.hpp). Plugins that it requires are loaded at once.
///
/// The root is a Node; nodes hold nodes and components (`<Class/>` or `<Object type="Class"/>`). Mistakes are collected
/// in the scene's diagnostics: call init() to have them thrown together. Throws FileError, PluginError, and SceneError
/// for a file that is not well-formed.
///
/// Files that it names and that do not lie beside it are looked for in the directories of `search`.
Scene read_scene(const std::filesystem::path& file, const Factory& factory, PluginLoader& plugins,
                 const SearchPath& search = {});

/// The same from text; `name` stands for the file in messages, and for the place from which includes are looked for.
Scene read_scene_text(std::string_view text, const std::string& name, const Factory& factory, PluginLoader& plugins,
                      const SearchPath& search = {});

/// Visits the nodes and components of a scene with the elements of the document that it was read from: what is in a
/// node before the node itself. What was added to the scene later has no element. `document`: read_document of the same
/// file.
void for_each_element(Scene& scene, Element& document, const std::function<void(Object&, Element&)>& visit);

/// The command line's `--set PATH.attribute=VALUE` means nothing in the scene: its path, attribute or link leads
/// nowhere, or its value is none of the attribute's. What the scene as a whole refuses is a SceneError of init.
class OverrideError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Replaces an attribute between reading and init: "bar/material.yieldStress=500", "root.dt=0.005". PATH is a link path
/// from the root, which may be named itself. `option` is what the command line calls it. Throws OverrideError.
void override_attribute(Scene& scene, std::string_view assignment, std::string_view option = "--set");

/// The attribute that `name`, PATH.attribute, means; `words` are the option of the command line that messages begin
/// with. Throws OverrideError.
Data& named_attribute(Scene& scene, std::string_view name, std::string_view words);

}  // namespace hexaplast::scene
