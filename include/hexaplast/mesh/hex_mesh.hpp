// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A validated mesh of trilinear hexahedra; nothing of it changes but by assignment.
class HexMesh {
 public:
  /// One element that a node belongs to, and which of its corners the node is.
  struct Incidence {
    int element;
    int corner;
  };

  /// positions: num_nodes x 3 [m]. Nodes without element are allowed.
  /// Throws InputError, naming the first ten elements concerned, when a coordinate is not finite, an index lies outside
  /// [0, num_nodes), an element names a node twice, or an element is inverted, flat or left-handed: the Jacobian must
  /// be positive at the Gauss points and not 0 at a corner.
  HexMesh(PointArray positions, std::vector<Hexahedron> hexahedra);

  /// The hexahedra of `other` some of whose nodes are several now, which is not checked again. node: for each present
  /// node the one of `other` that it was. hexahedra: present corners.
  HexMesh(const HexMesh& other, std::span<const int> node, std::vector<Hexahedron> hexahedra);

  int num_nodes() const { return static_cast<int>(positions_.rows()); }
  int num_elements() const { return static_cast<int>(hexahedra_.size()); }

  const PointArray& positions() const { return positions_; }  ///< initial positions X [m]
  const std::vector<Hexahedron>& hexahedra() const { return hexahedra_; }

  /// Elements around a node, in ascending order.
  std::span<const Incidence> incident(int node) const {
    return {incidence_.data() + first_[node], incidence_.data() + first_[node + 1]};
  }

  /// Per element and face (kFaces), an element that has the face too, or -1 where there is none. Of the elements that
  /// share a face each has another. Found when they are first asked for; copies of a mesh share them.
  const std::vector<std::array<int, 6>>& neighbours() const;

  /// Faces that belong to one element only, counter-clockwise seen from outside: the surface of the body.
  /// `alive`, if not empty, has one entry per element: only elements with a non-zero entry count.
  std::vector<Quad> boundary_faces(std::span<const unsigned char> alive = {}) const;

 private:
  void find_incidence();

  PointArray positions_;
  std::vector<Hexahedron> hexahedra_;
  std::vector<int> first_;            // num_nodes + 1 offsets into incidence_
  std::vector<Incidence> incidence_;  // grouped by node
  struct Neighbours {
    std::once_flag found;
    std::vector<std::array<int, 6>> across;
  };
  std::shared_ptr<Neighbours> neighbours_ = std::make_shared<Neighbours>();
};

/// The connected parts of a mesh of which some elements are gone.
struct ConnectedParts {
  std::vector<int> part_of_node;  ///< numbered by their first node; -1 for a node without live element
  int count = 0;
};

/// alive: one entry per element; elements with a zero entry do not connect.
ConnectedParts connected_parts(const HexMesh& mesh, std::span<const unsigned char> alive);

/// The rows of a nodal field at the corners of a hexahedron.
inline ElementPoints gather(ConstPoints field, const Hexahedron& corners) {
  ElementPoints at;
  for (int a = 0; a < kCorners; ++a) at.row(a) = field.row(corners[a]);
  return at;
}

/// nodal += per-corner values, each node adding its elements in ascending order: same bits for any number of threads.
void scatter(const HexMesh& mesh, const std::vector<ElementPoints>& corner, Points nodal);

}  // namespace hexaplast
