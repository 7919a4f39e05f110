// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/file.hpp"

#include <fmt/format.h>

#include "runner/exit_code.hpp"

namespace hexaplast::runner {

void require_vtu(const std::filesystem::path& file) {
  if (file.extension() != ".vtu") throw UsageError(fmt::format("--out {}: the name must end in .vtu", file.string()));
}

void save_mesh(const std::filesystem::path& file, const ExportedMesh& mesh, const InputFiles& inputs) {
  WholeFile out(output_place(file, inputs));
  out.write(vtu_text(mesh));
  out.commit();
}

}  // namespace hexaplast::runner
