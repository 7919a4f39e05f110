// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <vector>

#include "scene/output_files.hpp"

namespace hexaplast::runner {

/// Defines --allow-outside, for commands in which a scene's components write files.
void add_allow_outside(CLI::App& command, scene::OutputRules& rules);

/// The same, and --force.
void add_output_rules(CLI::App& command, scene::OutputRules& rules,
                      const char* force_help = "Replace files of an earlier run");

/// Defines --write-below, which --out excludes, for commands where that is the directory of a run.
void add_write_below(CLI::App& command, std::optional<std::filesystem::path>& write_below);

/// What a command writes by itself, or what a run would that it looks into.
struct OwnFiles {
  std::optional<std::filesystem::path> run = {};                 ///< directory of a run, with all its files
  std::vector<std::optional<std::filesystem::path>> named = {};  ///< by the command line

  /// Whether the run writes a file of that name, or makes a folder above it.
  bool has_in_run(const std::filesystem::path& file) const;
  bool has(const std::filesystem::path& file) const;
};

/// The rules of what a scene's components write into `directory`, beside the command's own files.
scene::OutputRules rules_beside(OwnFiles own, std::filesystem::path directory, scene::OutputRules rules);

/// Whether a scene's components write anything into `directory`, or below it.
bool writes_into(const scene::OutputFiles& files, const std::filesystem::path& directory);

}  // namespace hexaplast::runner
