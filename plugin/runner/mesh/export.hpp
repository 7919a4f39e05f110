// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast mesh export`, as the command line gives it.
struct MeshExportOptions {
  SceneOptions scene;
  std::string format;  ///< inp or vtu
  std::filesystem::path out;
  std::optional<double> time;  ///< [s] whose loads are written
};

/// Writes the body of a scene, as it is before the first step, for other programs. Throws what the modules below throw.
void export_mesh(const MeshExportOptions& options);

}  // namespace hexaplast::runner
