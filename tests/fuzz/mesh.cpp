// SPDX-License-Identifier: LGPL-2.1-or-later
// Mesh files: the first byte chooses the format. Whatever is read has its corners among its nodes.
#include "hexaplast/base/error.hpp"
#include "hexaplast/formats/mesh_import.hpp"
#include "target.hpp"

using namespace hexaplast;
using fuzz::require;

namespace {

template <class Cells>
void require_corners(const Cells& cells, long num_nodes) {
  for (const auto& cell : cells)
    for (const int node : cell) require(node >= 0 && node < num_nodes, "every corner is a node");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    const auto format = static_cast<MeshFormat>(data[0] % 4);
    ImportedMesh mesh = parse_mesh(fuzz::text_of(data + 1, size - 1), "any", format);
    const auto num_hexahedra = static_cast<int>(mesh.hexahedra.size());
    add_boundaries_of_cells(mesh);
    require_corners(mesh.edges, mesh.positions.rows());
    require_corners(mesh.triangles, mesh.positions.rows());
    require_corners(mesh.quads, mesh.positions.rows());
    require_corners(mesh.hexahedra, mesh.positions.rows());
    require(mesh.positions.allFinite(), "finite positions");
    for (const ImportedGroup& group : mesh.groups)
      for (const int e : group.hexahedra) require(e >= 0 && e < num_hexahedra, "every hexahedron is there");
  } catch (const InputError&) {
  }
  return 0;
}
