// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// `hexaplast resume`, as the command line gives it.
struct ResumeOptions {
  std::filesystem::path run;  ///< directory of a run, whose newest checkpoint counts, or a checkpoint in it
  std::optional<long> steps;  ///< of the whole run; otherwise as many as it was to have
  std::optional<int> threads;
  std::optional<std::filesystem::path> final_state;  ///< otherwise that of the run, if it had one
  bool quiet = false;
  std::vector<std::string> command;  ///< words of the command line, for the manifest
};

CLI::App* add_resume(CLI::App& app, ResumeOptions& options);

/// Goes on with a run from a checkpoint, in the directory from which it was begun, and returns what `run` returns.
/// Throws OutputError when there is no checkpoint or it cannot be read, InputError when it is damaged, of another
/// format version or of another scene, and what `run` throws.
int resume(const ResumeOptions& options);

}  // namespace hexaplast::runner
