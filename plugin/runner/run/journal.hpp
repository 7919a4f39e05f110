// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "record/manifest.hpp"
#include "runner/run/scene_file.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// The nodes and components of a scene in its order, each with the attributes that a scene file or the command line has
/// given other values than the default ones; RequiredPlugins, which do nothing in a run, are left out. Lists of many
/// numbers are described by how many there are and their XXH64.
std::vector<output::ComponentRecord> record_scene(scene::Scene& scene);

/// XXH64 of the files of a scene and of its options, before anything that they name is loaded: elements and attributes
/// of the document with its includes, overrides, plugins, grammar. Throws what reading a scene throws.
std::uint64_t hash_scene_files(const SceneOptions& options);

/// What the machine, the time and the scene's graph tell of a run that is about to begin.
output::Manifest describe_run(scene::Scene& scene);

/// Keeps manifest.json and report.html in the directory of a run. Both are whole at any moment.
class Journal {
 public:
  /// Writes the manifest of a run that begins. Throws OutputError.
  Journal(std::filesystem::path directory, output::Manifest manifest);

  /// Writes manifest and report of a run that has ended; `manifest` as it then is but for state, reason and duration.
  /// `reason` is a sentence without full stop. Throws OutputError.
  void close(output::RunState state, std::string reason);

  output::Manifest& manifest() { return manifest_; }

 private:
  std::filesystem::path directory_;
  output::Manifest manifest_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace hexaplast::runner
