// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "picture/shapes.hpp"
#include "record/manifest.hpp"
#include "view/session.hpp"

namespace hexaplast::view {

/// How a window begins, and what ends it besides the user.
struct WindowOptions {
  int width = 1440, height = 860;  ///< [pixels]
  bool is_running = false;         ///< from the beginning
  Pace pace = Pace::kRealTime;
  double speed = 1;                            ///< in real time
  std::filesystem::path picture_folder = ".";  ///< where pictures of the window go
  std::optional<long> steps;                   ///< runs so many steps as fast as they go, takes the picture, and closes
  std::optional<std::filesystem::path> picture;  ///< of the last moment
};

/// What the window is handed.
struct WindowCall {
  Session& session;
  output::Staging staging;
  std::vector<output::Bodies::Entry> bodies;
  std::vector<output::ProbeRecord> probes;
  WindowOptions options;
  std::function<bool()> is_asked_to_end;  ///< asked in every frame
};

/// The entry of the window module: shows a session until the window is closed, or something else asks for it. Throws
/// OutputError where no window can be opened or a picture cannot be written.
using ShowWindow = void (*)(WindowCall& call);

}  // namespace hexaplast::view
