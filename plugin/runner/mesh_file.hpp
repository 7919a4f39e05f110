// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/mesh/file_import.hpp"

namespace hexaplast::runner {

/// A mesh file that the command line names. Throws scene::FileError where there is no such file, and SceneError with
/// the place in the file where its content is wrong.
ImportedMesh load_mesh(const std::filesystem::path& file);

}  // namespace hexaplast::runner
