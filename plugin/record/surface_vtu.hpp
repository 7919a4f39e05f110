// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"
#include "picture/embedded_surface.hpp"

namespace hexaplast::output {

/// The surfaces that a body carries, as .vtu files show them beside its hexahedra.
class CarriedSurfaces {
 public:
  /// Throws InputError or NumericalError where a surface cannot be embedded.
  CarriedSurfaces(const HexMesh& mesh, std::vector<EmbeddedSurface> embedded_surfaces);

  bool empty() const { return embedded_surfaces_.empty(); }

  /// Writes all embedded surfaces as one VTK unstructured grid of triangles and quads (formats/vtu_grid.hpp), whose
  /// points move with the nodes at `positions` [m]:
  ///
  ///   point data: displacement [m], surface (number of the embedded surface), plastic_strain [-]
  ///
  /// mesh: the present one, some of whose nodes may have split; strains: plastic strain at the nodes, which is blended
  /// between them; alive: one per hexahedron, 0 for those that are removed: faces go with the hexahedra that carry
  /// them; open: faces between hexahedra, along which surfaces are cut; null: none. Of cut surfaces there is also
  ///
  ///   cell data: wall (1 for walls of cuts, else 0)
  ///
  /// Throws OutputError.
  void write(const std::filesystem::path& file, const HexMesh& mesh, ConstPoints positions,
             const std::vector<double>& strains, std::span<const unsigned char> alive, const OpenFaces* open = nullptr);

 private:
  std::vector<EmbeddedSurface> embedded_surfaces_;
  std::vector<Embedding> embeddings_;
};

/// The embedded surfaces of a file that was written when all faces were there. Throws InputError.
std::vector<EmbeddedSurface> read_embedded_surfaces(const std::filesystem::path& file);

}  // namespace hexaplast::output
