// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace hexaplast::runner {

struct ElementOptions {
  std::string file = "-";                     ///< JSON that describes the hexahedron; "-": standard input
  std::optional<std::filesystem::path> path;  ///< CSV of deformation gradients over time to drive it through
};

/// `hexaplast element`: one hexahedron, every intermediate of its elasticity and of one plastic step as JSON on
/// standard output, or with a path its response over time as CSV. The format is docs/element.md. Throws InputError
/// naming the key and value that is wrong, scene::FileError for a file that cannot be read.
void run_element(const ElementOptions& options);

}  // namespace hexaplast::runner
