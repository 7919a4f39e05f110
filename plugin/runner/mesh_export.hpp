// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hexaplast::runner {

/// `hexaplast mesh export`, as the command line gives it.
struct MeshExportOptions {
  std::filesystem::path scene;
  std::string format;  ///< inp or vtu
  std::filesystem::path out;
  std::optional<double> time;  ///< [s] whose loads are written
  std::vector<std::string> overrides;
  std::vector<std::filesystem::path> plugin_path;
};

/// Writes the body of a scene, as it is before the first step, for other programs. Throws what the rooms below throw.
void export_mesh(const MeshExportOptions& options);

}  // namespace hexaplast::runner
