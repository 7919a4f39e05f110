// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

namespace hexaplast::runner {

/// `hexaplast mesh cage`, as the command line gives it.
struct MeshCageOptions {
  std::filesystem::path surface;
  int cells = 0;  ///< cubes along the longest side of the surface's box
  std::filesystem::path out;
  bool allow_parts = false;
};

/// Writes the coarse hexahedra around a surface as .vtu, with the cell data `enclosed` (1 where the surface does not
/// pass), and prints what they are. Throws what the modules below throw; InputError for a cage that falls into parts,
/// unless they are allowed.
void make_cage(const MeshCageOptions& options);

}  // namespace hexaplast::runner
