// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runner/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast run`, as the command line gives it.
struct RunOptions {
  SceneOptions scene;
  std::vector<std::string> command;                  ///< words of the whole command line, for who wants to repeat it
  std::optional<long> steps;                         ///< otherwise from the scene's RunSettings
  std::optional<std::filesystem::path> out;          ///< directory of the run's files; none are written without it
  std::optional<std::filesystem::path> final_state;  ///< JSON of the last state
  std::optional<int> threads;
  std::optional<int> frames;                   ///< pictures; needs `out`
  std::string field;                           ///< what pictures show, by the word of a quantity; empty: plastic strain
  std::optional<std::filesystem::path> video;  ///< film of the run; needs `out`
  bool force = false;                          ///< write over an earlier run; needs `out`
  bool quiet = false;                          ///< errors only
};

/// Runs a scene headless and returns 0, or 130 or 143 when a signal ended it: then the current step is completed and
/// the files are whole. Throws what the rooms below throw.
int run(const RunOptions& options);

}  // namespace hexaplast::runner
