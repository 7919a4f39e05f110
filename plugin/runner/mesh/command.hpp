// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

#include "runner/command.hpp"

namespace hexaplast::runner {

// The subcommands of `mesh`.
void add_mesh_export(CLI::App& mesh, Call& call);
void add_mesh_offset(CLI::App& mesh, Call& call);
void add_mesh_cage(CLI::App& mesh, Call& call);
void add_mesh_grid(CLI::App& mesh, Call& call);
void add_mesh_sheet(CLI::App& mesh, Call& call);
void add_mesh_tube(CLI::App& mesh, Call& call);
void add_mesh_sphere_patch(CLI::App& mesh, Call& call);
void add_mesh_voxels(CLI::App& mesh, Call& call);
void add_mesh_info(CLI::App& mesh, Call& call);
void add_mesh_convert(CLI::App& mesh, Call& call);

/// -o, --out: the mesh file to write.
void add_out(CLI::App& command, std::filesystem::path& out);

}  // namespace hexaplast::runner
