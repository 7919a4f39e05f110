// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "picture/quantity.hpp"
#include "record/state_stream.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

// Options that several commands share.

void add_plugins(CLI::App& command, SceneOptions& options);
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

/// --quiet, which quietens the terminal at once; warnings are kept for the manifest of the run.
void add_quiet(CLI::App& command, bool& quiet);

/// What pictures show, and which way up.
struct PictureOptions {
  std::string field;                 ///< word of a quantity; empty: not given
  std::string up;                    ///< an axis, or one with a minus sign; empty: not given
  std::vector<std::string> regions;  ///< that are shown in a translucent body
};

/// --field, --region, --up
std::vector<CLI::Option*> add_pictures(CLI::App& command, PictureOptions& options);

/// --video: a film.
CLI::Option* add_video(CLI::App& command, std::optional<std::filesystem::path>& video, const char* help);

}  // namespace hexaplast::runner
