// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/formats/mesh_export.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast::runner {

/// A mesh file that the command line names. Throws scene::FileError where there is no such file, and SceneError with
/// the place in the file where its content is wrong.
ImportedMesh load_mesh(const std::filesystem::path& file);

/// Throws UsageError unless the name of the file to write ends in .vtu: to be asked before anything is computed.
void require_vtu(const std::filesystem::path& file);

/// Writes a mesh as .vtu; an older file stays until the new one is whole. Throws
/// OutputError, also where the file is one of `inputs`.
void save_mesh(const std::filesystem::path& file, const ExportedMesh& mesh, const InputFiles& inputs = {});

}  // namespace hexaplast::runner
