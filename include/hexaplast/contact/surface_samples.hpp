// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// A sample within a body may be held at the side that it came through, or at the nearest one. It is the former, unless
/// the latter faces it much more: a sample does not come in through a side that passes along its own surface.
inline bool faces_more(const Vec3& nearest, const Vec3& side, const Vec3& outwards) {
  constexpr double kMuchMore = 0.5;  // cosine
  return outwards.dot(side - nearest) > kMuchMore;
}

/// Nodes that have split since something was made: node first + i was split from node from[i].
struct SplitNodes {
  int first = std::numeric_limits<int>::max();
  std::span<const int> from = {};

  int before(int node) const { return node < first ? node : from[static_cast<std::size_t>(node - first)]; }
};

/// Points on the surface of a body, at which contact is looked for: its nodes, and as many between them on every face
/// as bring neighbours near enough to each other. A point that several faces have is there once.
///
///   p = sum_a w_a x_a, sum_a w_a = 1                                     sum of all areas = area of the surface
struct SurfaceSamples {
  struct Sample {
    std::array<int, kCorners> nodes = {};
    std::array<double, kCorners> weights = {};
    int num_nodes = 0;  ///< that move it
    double area = 0;    ///< [m^2] in the initial shape

    /// The nodes that move it and their weights, in one order: the same point may be written down by another of the
    /// faces that have it. split: the nodes are those that these were before.
    std::array<std::pair<int, double>, kCorners> key(const SplitNodes& split = {}) const {
      std::array<std::pair<int, double>, kCorners> sorted;
      sorted.fill({-1, 0});
      for (int a = 0; a < num_nodes; ++a) sorted[a] = {split.before(nodes[a]), weights[a]};
      std::ranges::sort(sorted);
      return sorted;
    }

    Vec3 at(ConstPoints x) const {
      Vec3 p = Vec3::Zero();
      for (int a = 0; a < num_nodes; ++a) p += weights[a] * x.row(nodes[a]).transpose();
      return p;
    }
    void add(const Vec3& vector, Points f) const {
      for (int a = 0; a < num_nodes; ++a) f.row(nodes[a]) += weights[a] * vector.transpose();
    }
  };

  std::vector<Sample> samples;
  std::vector<std::array<int, 4>> faces = {};  ///< of the surface, by the samples at their corners; triangles a b c a
  std::vector<int> first_face = {},
                   faces_around = {};       ///< of sample i: faces_around[first_face[i]] to [first_face[i + 1] - 1]
  double spacing = 0;                       ///< [m] the largest distance between neighbours
  std::shared_ptr<const void> memory = {};  ///< counts as taken while this is there

  /// Out of the body at a sample: the mean normal of the faces around it at x, by their areas, of length 1; or 0.
  Vec3 outwards(int sample, ConstPoints x) const;

  /// On the faces of the mesh. Parts of an edge of a face: as many as make neighbours no farther apart than `wanted`
  /// [m], but not more than `max_parts`. alive: empty, or one per hexahedron. Throws InputError for a `wanted` or
  /// `max_parts` that is not positive, and for more samples than there is memory for.
  static SurfaceSamples on(const HexMesh& mesh, std::span<const unsigned char> alive, double wanted, int max_parts);

  /// The same on triangles that are embedded in the hexahedra (Embedding) and have the positions `surface` [m] in the
  /// initial shape. Triangles of which a point lies in a hexahedron that is gone are left out. Throws what Embedding
  /// throws, and InputError for a node that is not there.
  static SurfaceSamples on_embedded(const HexMesh& mesh, std::span<const unsigned char> alive, ConstPoints surface,
                                    const std::vector<Triangle>& triangles, double wanted, int max_parts);

  /// The spacing and the memory of what `on` and `on_embedded` make, without a sample.
  static SurfaceSamples planned_on(const HexMesh& mesh, std::span<const unsigned char> alive, double wanted,
                                   int max_parts);
  static SurfaceSamples planned_on_embedded(ConstPoints surface, const std::vector<Triangle>& triangles, double wanted,
                                            int max_parts);
};

}  // namespace hexaplast
