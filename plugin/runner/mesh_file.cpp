// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh_file.hpp"

#include "hexaplast/base/error.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {

ImportedMesh load_mesh(const std::filesystem::path& file) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure))
    throw scene::FileError(scene::format_error({file.string(), 0}, "no such file"));
  try {
    return read_mesh(file);
  } catch (const InputError& error) {  // says the place itself
    throw scene::SceneError(scene::format_error({"hexaplast", 0}, error.what()));
  }
}

}  // namespace hexaplast::runner
