// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::runner {

/// `hexaplast mesh info`, as the command line gives it.
struct MeshInfoOptions {
  std::filesystem::path file;
  bool json = false;
};

/// `hexaplast mesh convert`, as the command line gives it.
struct MeshConvertOptions {
  std::filesystem::path file;
  std::filesystem::path out;
};

/// Prints what a mesh file holds: counts, size, volume and shape of hexahedra, and how far a surface of quads can be
/// offset. Throws what the modules below throw; InputError for hexahedra that make no mesh.
void print_info(const MeshInfoOptions& options);

/// Writes the cells of a mesh file in another format. Nothing is judged or changed; cells of kinds that we do not read
/// are left out, with a warning.
void convert(const MeshConvertOptions& options);

/// The lines of `mesh info` that speak of hexahedra.
void print_hexahedra(const HexMesh& mesh);

}  // namespace hexaplast::runner
