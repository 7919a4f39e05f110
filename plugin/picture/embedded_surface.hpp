// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "hexaplast/geometry/embed.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::output {

/// A surface that moves with the hexahedra of a body.
struct EmbeddedSurface {
  PointArray points;  ///< any number x 3 [m], in the body's initial positions
  std::vector<Triangle> triangles;
  std::vector<Quad> quads;
  int first_hexahedron = 0, num_hexahedra = -1;  ///< of those that move it; -1: all

  std::span<const Hexahedron> carriers(const HexMesh& mesh) const {
    return std::span(mesh.hexahedra())
        .subspan(static_cast<std::size_t>(first_hexahedron),
                 num_hexahedra < 0 ? std::dynamic_extent : static_cast<std::size_t>(num_hexahedra));
  }
  Embedding embedding(const HexMesh& mesh) const { return {mesh.positions(), carriers(mesh), points}; }
};

/// Whether a face of embedded points is shown where hexahedra have gone: with those that carry its corners. alive: one
/// per hexahedron, 0 for those that are removed; empty: all are there.
inline bool is_carried(std::span<const int> face, const EmbeddedSurface& surface, const Embedding& embedding,
                       std::span<const unsigned char> alive) {
  return alive.empty() || std::ranges::all_of(face, [&](int point) {
           return alive[surface.first_hexahedron + embedding.hexahedron_of(point)] != 0;
         });
}

}  // namespace hexaplast::output
