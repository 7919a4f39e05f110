// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hexaplast/formats/whole_file.hpp"
#include "scene/diagnostics.hpp"

namespace hexaplast::scene {

/// Where the files are looked for that a scene names: meshes and includes.
class SearchPath {
 public:
  SearchPath() = default;
  explicit SearchPath(std::vector<std::filesystem::path> directories) : directories_(std::move(directories)) {}

  /// The file of that name. An absolute name is the file itself. Others count from `folder`, that of the file that
  /// names it; where nothing is there, from the directories of this path in their order. Names with `..` count from
  /// `folder` alone. Where nothing is found, the place in `folder`.
  std::filesystem::path find(const std::filesystem::path& name, const std::filesystem::path& folder) const;

  /// "looked for in A and B too", for a name that nothing is found of; empty where there is nothing to add.
  std::string places_of(const std::filesystem::path& name) const;

 private:
  bool looks_for(const std::filesystem::path& name) const;

  std::vector<std::filesystem::path> directories_;
};

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
