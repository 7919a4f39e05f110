// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// What holds the hexahedra of a body together: faces that two or more of them have, and hinges, which are pairs that
/// meet at nodes where no chain of faces joins them. Found in the initial mesh alone.            theory.md section 10
///
/// Numbered: faces first, in the order of their names, then hinges in the order of theirs.
///
/// The hinges of a node tie the groups of hexahedra that faces join there: each group after the first, in the order of
/// their lowest hexahedra, by one pair of a hexahedron before it and one of its own; the lowest pair that has an edge
/// at the node in common, else the two lowest hexahedra.
class Joints {
 public:
  struct Face {
    int hexahedron;  ///< the lowest one that has it
    int side;        ///< index into kFaces
    bool operator==(const Face&) const = default;
  };
  struct Hinge {
    int first, second;  ///< hexahedra, ascending
    bool operator==(const Hinge&) const = default;
  };

  explicit Joints(const HexMesh& initial);

  int count() const { return num_faces() + num_hinges(); }
  int num_faces() const { return static_cast<int>(faces_.size()); }
  int num_hinges() const { return static_cast<int>(hinges_.size()); }
  const std::vector<Face>& faces() const { return faces_; }
  const std::vector<Hinge>& hinges() const { return hinges_; }

  /// The number of a joint; -1 where there is none. A face may be named by any hexahedron that has it.
  int find(Face face) const;
  int find(Hinge hinge) const;

  std::span<const int> hexahedra(int joint) const { return hexahedra_[joint]; }  ///< that it holds, ascending
  std::span<const int> nodes(int joint) const { return nodes_[joint]; }          ///< initial nodes at which it does

  /// Of an element: the face joint on each of its sides, -1 where the side is free.
  const std::array<int, 6>& across(int hexahedron) const { return across_[hexahedron]; }
  /// Of an initial node: its hinges.
  std::span<const int> hinges_at(int node) const { return hinges_at_[node]; }

 private:
  struct Lists {  // one after the other
    std::vector<int> first{0}, values;
    void close() { first.push_back(static_cast<int>(values.size())); }
    std::span<const int> operator[](int k) const { return {values.data() + first[k], values.data() + first[k + 1]}; }
  };
  std::vector<Face> faces_;
  std::vector<Hinge> hinges_;
  std::vector<std::array<int, 6>> across_;
  Lists hexahedra_, nodes_, hinges_at_;
};

}  // namespace hexaplast
