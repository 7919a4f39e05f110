// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "record/manifest.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

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
