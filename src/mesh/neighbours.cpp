// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/neighbours.hpp"

#include <algorithm>

namespace hexaplast {

std::vector<std::array<int, 6>> neighbours_across_faces(std::span<const Hexahedron> hexahedra,
                                                        std::span<const unsigned char> alive) {
  struct Face {
    Quad nodes;  // sorted
    int element, side;
  };
  std::vector<Face> faces;
  faces.reserve(hexahedra.size() * 6);
  for (int e = 0; e < static_cast<int>(hexahedra.size()); ++e) {
    if (!alive.empty() && !alive[e]) continue;
    for (int side = 0; side < 6; ++side) faces.push_back({sorted(face_of(hexahedra[e], kFaces[side])), e, side});
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.nodes != b.nodes ? a.nodes < b.nodes : a.element < b.element;
  });
  std::vector<std::array<int, 6>> across(hexahedra.size());
  for (auto& row : across) row.fill(-1);
  for (std::size_t k = 1; k < faces.size(); ++k) {
    if (faces[k].nodes != faces[k - 1].nodes) continue;
    across[faces[k].element][faces[k].side] = faces[k - 1].element;
    across[faces[k - 1].element][faces[k - 1].side] = faces[k].element;
  }
  return across;
}

}  // namespace hexaplast
