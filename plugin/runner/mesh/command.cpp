// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/command.hpp"

#include <CLI/CLI.hpp>

namespace hexaplast::runner {

void add_out(CLI::App& command, std::filesystem::path& out) {
  command.add_option("-o,--out", out, "File to write, .vtu; replaces an older one")->type_name("FILE")->required();
}

void add_mesh(CLI::App& app, Call& call) {
  CLI::App* mesh = app.add_subcommand("mesh", "Make meshes, and write those of scenes");
  mesh->require_subcommand(1);
  for (const auto add : {add_mesh_export, add_mesh_offset, add_mesh_cage, add_mesh_grid, add_mesh_sheet, add_mesh_tube,
                         add_mesh_sphere_patch, add_mesh_voxels, add_mesh_info, add_mesh_convert})
    add(*mesh, call);
}

}  // namespace hexaplast::runner
