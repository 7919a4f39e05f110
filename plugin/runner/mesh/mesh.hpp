// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>

#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_export.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/formats/whole_file.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "runner/command.hpp"
#include "scene/reader.hpp"

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

/// What `read` makes of a file that the command line names. Throws scene::FileError where there is no such file, and
/// SceneError with the place in the file where its content is wrong, which `read` says in an InputError.
template <class Read>
auto load_file(const std::filesystem::path& file, const Read& read) {
  scene::require_readable(file);
  try {
    return read();
  } catch (const InputError& error) {
    throw scene::SceneError(scene::format_error({"hexaplast", 0}, error.what()));
  }
}
inline ImportedMesh load_mesh(const std::filesystem::path& file) {
  return load_file(file, [&] { return read_mesh(file); });
}

/// Throws UsageError unless the name of the file to write ends in .vtu: to be asked before anything is computed.
void require_vtu(const std::filesystem::path& file);

/// Coordinates one after the other.
inline std::span<const double> coordinates_of(const PointArray& points) {
  return {points.data(), static_cast<std::size_t>(points.size())};
}

/// Writes a mesh as .vtu; an older file stays until the new one is whole. Throws OutputError, also where the file is
/// one of `inputs`.
void save_mesh(const std::filesystem::path& file, const ExportedMesh& mesh, const InputFiles& inputs);

/// The lines of `mesh info` that speak of hexahedra.
void print_hexahedra(const HexMesh& mesh);

}  // namespace hexaplast::runner
