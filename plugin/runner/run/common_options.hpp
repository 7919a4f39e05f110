// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "record/state_stream.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

// Options that several commands share.

inline constexpr const char* kExitCodes =
    "Exit codes: 0 ok, 2 usage, 3 scene or mesh rejected, 4 numerical failure, 5 input/output, 6 plugin, 130/143 "
    "interrupted.";

void add_plugin_options(CLI::App& command, std::vector<std::string>& plugins,
                        std::vector<std::filesystem::path>& plugin_path);

void add_mesh_path(CLI::App& command, SceneOptions& options);

/// What every command that reads a scene takes.
void add_scene(CLI::App& command, SceneOptions& options);

void add_threads(CLI::App& command, std::optional<int>& threads,
                 const char* help = "Number of threads; results do not depend on it");

CLI::Option* add_steps(CLI::App& command, std::optional<long>& steps,
                       const char* help = "Number of time steps; default: that of the scene's RunSettings");

/// --final
void add_final_state(CLI::App& command, std::optional<std::filesystem::path>& file);

/// --fields and --every: what data sets hold.
std::string why_no_fields(const std::vector<std::string>& words);  ///< empty: they are fields
CLI::Option* add_fields(CLI::App& command, std::vector<output::Field>& fields);
CLI::Option* add_every(CLI::App& command, long& every);

void add_strict(CLI::App& command, bool& strict);

}  // namespace hexaplast::runner
