// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/neighbours.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "base/require.hpp"

namespace hexaplast {

std::vector<std::array<int, 6>> neighbours_across_faces(std::span<const Hexahedron> hexahedra) {
  std::vector<std::array<int, 6>> across(hexahedra.size());
  std::vector<Quad> nodes(6 * hexahedra.size());  // sorted, of face 6 e + side
  const std::size_t mask = std::bit_ceil(8 * hexahedra.size()) - 1;
  std::vector<int> latest(mask + 1, -1);  // of the faces with the same nodes, by the hash of these
  for (int e = 0; e < static_cast<int>(hexahedra.size()); ++e) {
    across[e].fill(-1);
    for (int side = 0; side < 6; ++side) {
      const int face = 6 * e + side;
      nodes[face] = sorted(face_of(hexahedra[e], kFaces[side]));
      std::uint64_t key = 0;
      for (const int node : nodes[face]) {
        key = (key ^ static_cast<std::uint64_t>(node)) * 0x9e3779b97f4a7c15u;
        key ^= key >> 32;
      }
      std::size_t at = key & mask;
      while (latest[at] >= 0 && nodes[latest[at]] != nodes[face]) at = (at + 1) & mask;
      if (const int other = latest[at]; other >= 0) {
        across[e][side] = other / 6;
        across[other / 6][other % 6] = e;
      }
      latest[at] = face;
    }
  }
  return across;
}

std::vector<std::array<int, 6>> neighbours_across_faces(const HexMesh& mesh, std::span<const unsigned char> alive) {
  std::vector<std::array<int, 6>> across = mesh.neighbours();
  if (alive.empty()) return across;
  // three elements may share a face, and one of them be gone
  const auto another = [&](int e, int side) {
    const Quad face = face_of(mesh.hexahedra()[e], kFaces[side]);
    for (const HexMesh::Incidence& at : mesh.incident(face[0])) {
      const Hexahedron& nodes = mesh.hexahedra()[at.element];
      const bool has_all = std::ranges::all_of(face, [&](int node) { return std::ranges::count(nodes, node) > 0; });
      if (at.element != e && alive[at.element] && has_all) return at.element;
    }
    return -1;
  };
  for (int e = 0; e < mesh.num_elements(); ++e) {
    if (!alive[e]) across[e].fill(-1);
    for (int side = 0; side < 6; ++side)
      if (const int other = across[e][side]; other >= 0 && !alive[other]) across[e][side] = another(e, side);
  }
  return across;
}

std::vector<BoundaryFace> boundary_of(const HexMesh& mesh, std::span<const unsigned char> alive) {
  if (!alive.empty()) require_count("boundary_faces", "alive", std::ssize(alive), mesh.num_elements());
  const std::vector<std::array<int, 6>> across = neighbours_across_faces(mesh, alive);
  std::vector<BoundaryFace> boundary;
  for (int e = 0; e < mesh.num_elements(); ++e) {
    if (!alive.empty() && !alive[e]) continue;
    for (int side = 0; side < 6; ++side)
      if (across[e][side] < 0) boundary.push_back({face_of(mesh.hexahedra()[e], kFaces[side]), e});
  }
  std::ranges::sort(boundary, {}, [](const BoundaryFace& face) { return sorted(face.nodes); });
  return boundary;
}

}  // namespace hexaplast
