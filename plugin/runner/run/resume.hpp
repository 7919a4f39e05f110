// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast resume`, as the command line gives it.
struct ResumeOptions {
  std::filesystem::path run;  ///< directory of a run, whose newest checkpoint counts, or a checkpoint in it
  std::optional<long> steps;  ///< of the whole run; otherwise as many as it was to have
  std::optional<int> threads;
  std::optional<std::filesystem::path> final_state, summary;
  std::vector<std::filesystem::path> plugin_path;  ///< where plugins are looked for before the installation
  bool quiet = false;
  bool strict = false;
  std::vector<std::string> command;  ///< words of the command line, for the manifest
};

CLI::App* add_resume(CLI::App& app, ResumeOptions& options);

/// Goes on with a run from a checkpoint and returns what `run` returns. A stranger may have made the directory: nothing
/// in it says what is loaded, or written where outside of it; that is for these options alone. No plugin is loaded
/// before all is checked that can be without it. Throws OutputError when there is no checkpoint or it cannot be read,
/// InputError when it is damaged, of another format version or of another scene, and what `run` throws.
int resume(const ResumeOptions& options);

}  // namespace hexaplast::runner
