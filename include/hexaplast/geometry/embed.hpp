// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Points that move with hexahedra: p = J x, each point a fixed combination of the eight corners of one hexahedron.
///
///   inside a hexahedron    w_a = N_a(s) at the exact trilinear coordinates s of the point
///   outside all of them    w_a = N_a(s) + grad N_a(s) . (p - x(s)),  s being the nearest place of the nearest one:
///                          the first order continuation
///
/// Either way the weights add up to 1 and give back the point where it was. Forces on points thus act on nodes, f = J^T
/// f_p, with the same sum and the same moment.
class Embedding {
 public:
  /// x: num_nodes x 3 [m], hexahedra with corners in x, right side out; points: any number x 3 [m]. Throws InputError
  /// when there is no hexahedron or a corner is not in x, NumericalError when a position or a point is not finite. Each
  /// point looks at the few hexahedra around it, however many there are.
  Embedding(ConstPoints x, std::span<const Hexahedron> hexahedra, ConstPoints points);

  /// The same where it is known which hexahedron moves each point, inside or not.
  Embedding(ConstPoints x, std::span<const Hexahedron> hexahedra, ConstPoints points,
            std::span<const int> hexahedron_of_point);

  int num_points() const { return static_cast<int>(anchors_.size()); }

  /// The hexahedron that a point lies in, or the nearest one.
  int hexahedron_of(int point) const { return anchors_[point].hexahedron; }

  /// w_a, by which the eight corners of that hexahedron move it.
  const std::array<double, kCorners>& weights_of(int point) const { return anchors_[point].weight; }

  /// How many points lie outside all hexahedra, and the largest distance [m] of one from them.
  int num_outside() const { return num_outside_; }
  double greatest_distance() const { return greatest_distance_; }

  /// Whether a cell of these points is left where hexahedra have gone, so that it may be shown: each of its points is
  /// carried, and all of them together are. `hold_together` answers for nodes: false when the hexahedra that had all of
  /// them are gone (faces.hpp). A point on a node, edge or face is carried by any hexahedron that has it; one
  /// outside goes with its nearest hexahedron. Cells are expected to be no larger than hexahedra: one that spans
  /// several goes when a point goes.
  bool is_left(std::span<const int> cell, const std::function<bool(std::span<const int> nodes)>& hold_together) const;

  /// Points go on with the same hexahedra, whose corners are others now. hexahedra: as many as at first. Throws
  /// InputError for another number of them, and for a corner that is not below num_nodes.
  void follow(std::span<const Hexahedron> hexahedra, int num_nodes);

  // Throw InputError for a field of other than num_nodes or num_points rows, or matrices of other sizes.

  void apply(ConstPoints nodes, Points points) const;           ///< points = J nodes
  void add_transposed(ConstPoints points, Points nodes) const;  ///< nodes += J^T points

  /// A += J^T B J.
  void add_transposed_blocks(const BlockMatrix& B, BlockMatrix& A) const;

 private:
  struct Anchor {
    int hexahedron;
    Hexahedron corners;
    std::array<double, kCorners> weight;
  };
  Eigen::Index num_nodes_;
  std::ptrdiff_t num_hexahedra_;
  std::vector<Anchor> anchors_;
  int num_outside_ = 0;
  double greatest_distance_ = 0;
};

}  // namespace hexaplast
