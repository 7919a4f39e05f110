// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "picture/quantity.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace hexaplast::runner {

/// `hexaplast render`, as the command line gives it.
struct RenderOptions {
  std::filesystem::path run;  ///< directory of a run, or its .pvd file
  std::filesystem::path out = "render.png";
  std::optional<std::filesystem::path> video;  ///< film of all states, instead of one picture
  std::optional<double> time;                  ///< [s] the state nearest to it; otherwise the last one
  std::optional<long> step;
  std::string field, range, view, camera, size, slice, sections;  ///< see add_render; empty: not given
  std::string shape = "current";
  std::string ghost = "initial";
  std::string show;  ///< surfaces, hexahedra or both; empty: as the scene says
  bool no_edges = false;
  bool no_marks = false;
};

/// Defines the subcommand.
CLI::App* add_render(CLI::App& app, RenderOptions& options);

/// Defines --field, which says what pictures show, for any command that makes some.
CLI::Option* add_field(CLI::App& command, std::string& field);

/// The quantity of a checked --field; plastic strain where none is given.
output::Quantity quantity_named(const std::string& field);

/// A check of CLI11's: why a film cannot be called so.
std::string refuse_film_name(const std::string& file);

/// Makes a picture or a film of a run that is finished. Throws what the modules below throw, and UsageError for options
/// that make no sense, alone or for this run.
void render(const RenderOptions& options);

}  // namespace hexaplast::runner
