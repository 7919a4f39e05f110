// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast fit`, as the command line gives it.
struct FitOptions {
  SceneOptions scene;
  std::filesystem::path target;                       ///< CSV (target_curve.hpp)
  std::vector<std::string> compare;                   ///< columns of it; empty: all
  std::vector<std::vector<std::string>> experiments;  ///< further ones: scene, curve, then columns to compare and
                                                      ///< PATH.attribute=VALUE for this one
  std::vector<std::string> free;                      ///< PATH.attribute=lo:hi[:log|:linear]; of every scene
  std::optional<std::filesystem::path> out;  ///< directory of fit.json and fit.svg; none are written without it
  std::optional<long> steps;                 ///< of curves over force, otherwise from the scene's RunSettings
  int jobs = 0;                              ///< runs at a time; 0: as many as there are processors
  std::optional<int> threads;                ///< of each run
  int evaluations = 200;   ///< runs of the scene at most, without those that tell how well the values are known
  bool force = false;      ///< write over an earlier fit; needs `out`
  std::vector<int> asks;   ///< sockets of programs that evaluate, in place of processes of this one
  bool is_worker = false;  ///< answers another fit's questions (worker.hpp)
};

/// Adds the subcommand with the options that are its own.
CLI::App* add_fit(CLI::App& app, FitOptions& options);

/// Finds the values of attributes with which a scene comes closest to a measured curve (least squares), or several
/// scenes to a curve each, and says how well the curves tell them. Returns 0, or 130 or 143 when a signal ended it;
/// nothing is written then. Throws UsageError and OverrideError for what the command line gets wrong, FileError and
/// SceneError for the curve, and what a run of the scene throws where the first one fails.
int fit(const FitOptions& options);

}  // namespace hexaplast::runner
