// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "runner/run/scene_file.hpp"

namespace CLI {
class App;
}

namespace hexaplast::runner {

/// `hexaplast view`, as the command line gives it.
struct ViewOptions {
  SceneOptions scene;
  bool is_running = false;                           ///< from the beginning
  bool is_free = false;                              ///< as fast as it goes, instead of real time
  double speed = 1;                                  ///< in real time
  std::optional<long> steps;                         ///< after which the window closes
  std::filesystem::path pictures = ".";              ///< where those go that are taken by hand
  std::optional<std::filesystem::path> picture;      ///< of the window's last moment
  std::optional<std::filesystem::path> final_state;  ///< JSON of the last state
  std::optional<std::filesystem::path> record;       ///< scene that repeats what was done
  std::optional<int> threads;
  int width = 1440, height = 860;  ///< [pixels]
};

/// The options of the subcommand `view` besides those of its scene.
void add_view_options(CLI::App& view, ViewOptions& options);

/// Shows a scene, or a run that is finished, in a window until that is closed, and prints what became of it. Throws
/// PluginError where the window is not part of the build or cannot be loaded, OutputError where none can be opened,
/// NumericalError where it was closed on a step that failed, and what the modules below throw.
int view(const ViewOptions& options);

}  // namespace hexaplast::runner
