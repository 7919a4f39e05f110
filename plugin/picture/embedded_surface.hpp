// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "hexaplast/geometry/cut_surface.hpp"
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

  /// It, cut along with the hexahedra. original: embedding of its points; faces: its own; walls: null where none are
  /// open.
  CarriedSurface cut(const HexMesh& mesh, const Embedding& original, std::vector<Quad> faces,
                     const CutWalls* walls) const {
    const auto count = static_cast<int>(carriers(mesh).size());
    if (walls) return cut_skin(*walls, points, faces, original, first_hexahedron, count);
    CarriedSurface whole{points, {}, std::move(faces), {}};
    for (int n = 0; n < original.num_points(); ++n)
      whole.hexahedron.push_back(first_hexahedron + original.hexahedron_of(n));
    whole.is_wall.assign(whole.faces.size(), 0);
    return whole;
  }
  Embedding embedding(const HexMesh& mesh, const CarriedSurface& of_it) const {
    std::vector<int> own;
    for (const int e : of_it.hexahedron) own.push_back(e - first_hexahedron);
    return {mesh.positions(), carriers(mesh), of_it.points, own};
  }
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
