// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast mesh export`, as the command line gives it.
struct MeshExportOptions {
  SceneOptions scene;
  std::filesystem::path out;
};

/// Writes the bodies of a scene, as they are before the first step, for other programs. Throws what the modules below
/// throw.
void export_mesh(const MeshExportOptions& options);

}  // namespace hexaplast::runner
