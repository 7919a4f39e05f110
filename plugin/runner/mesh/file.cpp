// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/file.hpp"

#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "record/files.hpp"
#include "runner/exit_code.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

using Write = std::string (*)(const ExportedMesh&);

Write writer_of(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".vtu") return vtu_text;
  if (ending == ".msh") return gmsh_text;
  throw UsageError(fmt::format("--out {}: the name must end in .vtu or .msh", file.string()));
}

}  // namespace

ImportedMesh load_mesh(const std::filesystem::path& file) {
  scene::require_readable(file);
  try {
    return read_mesh(file);
  } catch (const InputError& error) {  // says the place itself
    throw scene::SceneError(scene::format_error({"hexaplast", 0}, error.what()));
  }
}

void require_writable_format(const std::filesystem::path& file) { writer_of(file); }

void save_mesh(const std::filesystem::path& file, const ExportedMesh& mesh, const InputFiles& inputs) {
  const std::string text = writer_of(file)(mesh);
  output::WholeFile out(output_place(file, inputs));
  out.write(text);
  out.commit();
}

}  // namespace hexaplast::runner
