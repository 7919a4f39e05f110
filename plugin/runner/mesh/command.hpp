// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>

#include "runner/mesh/cage.hpp"
#include "runner/mesh/export.hpp"
#include "runner/mesh/info.hpp"
#include "runner/mesh/make.hpp"
#include "runner/mesh/voxels.hpp"

namespace hexaplast::runner {

/// What the subcommands of `mesh` take.
struct MeshOptions {
  MeshExportOptions scene_export;
  MeshCageOptions cage;
  MeshOffsetOptions offset;
  MeshGridOptions grid;
  MeshSheetOptions sheet;
  MeshTubeOptions tube;
  MeshSpherePatchOptions sphere_patch;
  MeshVoxelsOptions voxels;
  MeshInfoOptions info;
  MeshConvertOptions convert;
};

/// `hexaplast mesh` and its subcommands.
void add_mesh(CLI::App& app, MeshOptions& options);

/// Carries out the subcommand that the command line names and returns its exit code.
int run_mesh(const CLI::App& mesh, const MeshOptions& options);

}  // namespace hexaplast::runner
