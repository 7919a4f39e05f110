// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A validated, immutable surface of quads: an oriented manifold, open or closed, in one part or several. Its outer
/// side is the one from which the corners of the quads run counter-clockwise.
class QuadSurface {
 public:
  /// One quad that a vertex belongs to, and which of its corners the vertex is.
  struct Incidence {
    int quad;
    int corner;
  };

  /// positions: num_vertices x 3 [m].
  /// Throws InputError, naming the first ten quads or vertices concerned, when there is no quad, a coordinate is not
  /// finite, an index lies outside [0, num_vertices), a quad names a vertex twice, a vertex belongs to no quad, two
  /// vertices lie at one place, an edge belongs to more than two quads, neighbours are oriented differently, quads meet
  /// in a vertex only, or a corner of a quad is flat, concave or twisted away from the quad's own side.
  QuadSurface(PointArray positions, std::vector<Quad> quads);

  int num_vertices() const { return static_cast<int>(positions_.rows()); }
  int num_quads() const { return static_cast<int>(quads_.size()); }

  const PointArray& positions() const { return positions_; }
  const std::vector<Quad>& quads() const { return quads_; }

  /// Quads around a vertex, in ascending order.
  std::span<const Incidence> incident(int vertex) const {
    return {incidence_.data() + first_[vertex], incidence_.data() + first_[vertex + 1]};
  }

  /// Every edge belongs to two quads.
  bool is_closed() const { return is_closed_; }

  /// Where corner `corner` of a quad lies [m], corners counted around.
  Vec3 at(int quad, int corner) const { return positions_.row(quads_[quad][(corner + 4) % 4]).transpose(); }

 private:
  void check_edges();
  void check_fans() const;
  void check_shapes() const;

  PointArray positions_;
  std::vector<Quad> quads_;
  std::vector<int> first_;            // num_vertices + 1 offsets into incidence_
  std::vector<Incidence> incidence_;  // grouped by vertex
  bool is_closed_ = true;
};

}  // namespace hexaplast
