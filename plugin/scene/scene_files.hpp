// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

#include "hexaplast/formats/whole_file.hpp"
#include "scene/diagnostics.hpp"
#include "scene/search_path.hpp"

namespace hexaplast::scene {

/// What a scene reads.
struct SceneFiles {
  InputFiles inputs;  ///< the scene, its includes, and the meshes that it names
  SearchPath search;  ///< of these meshes

  /// The file that a component names, found and added to `inputs`. by: where the component stands.
  std::filesystem::path input(const std::filesystem::path& name, const Place& by) {
    const std::filesystem::path file = search.find(name, std::filesystem::path(by.file).parent_path());
    inputs.add(file);
    return file;
  }
};

}  // namespace hexaplast::scene
