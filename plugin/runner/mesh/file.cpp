// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/file.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "record/files.hpp"
#include "runner/exit_code.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {

ImportedMesh load_mesh(const std::filesystem::path& file) {
  scene::require_readable(file);
  try {
    return read_mesh(file);
  } catch (const InputError& error) {  // says the place itself
    throw scene::SceneError(scene::format_error({"hexaplast", 0}, error.what()));
  }
}

void require_vtu(const std::filesystem::path& file) {
  if (file.extension() != ".vtu") throw UsageError(fmt::format("--out {}: the name must end in .vtu", file.string()));
}

void save_mesh(const std::filesystem::path& file, const ExportedMesh& mesh, const InputFiles& inputs) {
  output::WholeFile out(output_place(file, inputs));
  out.write(vtu_text(mesh));
  out.commit();
}

}  // namespace hexaplast::runner
