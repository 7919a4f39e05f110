// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/mesh/joints.hpp"

namespace hexaplast {

/// The present nodes of a mesh some joints of which are open: of each initial node one copy per group of hexahedra that
/// closed joints connect there. The first copy keeps the initial node's number.                theory.md section 10
///
/// What belongs to initial nodes (forces, springs, constraints) follows from the present copies and their shares alone,
/// whatever the copies were before.
class NodeCopies {
 public:
  explicit NodeCopies(int num_initial_nodes);

  int num_initial() const { return num_initial_; }
  int num_nodes() const { return static_cast<int>(initial_.size()); }
  bool is_split() const { return num_nodes() > num_initial(); }

  /// Per present node: the initial one that it is a copy of.
  const std::vector<int>& initial() const { return initial_; }

  /// Per present node: the initial volume of its hexahedra over that of all at its initial node. Up to rounding the
  /// shares of an initial node sum to 1.
  const std::vector<double>& share() const { return share_; }

  /// The present nodes at an initial one, ascending: itself first.
  std::span<const int> of(int initial) const {
    return {copies_.data() + first_[initial], copies_.data() + first_[initial + 1]};
  }

  /// Splits nodes at joints that open, call by call.
  ///   opened: joints; end_of_call: per call, where its own end in `opened`. is_open: per joint, before and then after.
  ///   volume: [m^3] per hexahedron, initial. hexahedra: present corners, which change.
  /// In a call, present nodes that split are taken in ascending order, their groups in the order of their lowest
  /// hexahedron: the first keeps the number, the others get the next free ones. Returns per new node the one that it
  /// was split from.
  std::vector<int> split(const HexMesh& initial, const Joints& joints, std::span<const int> opened,
                         std::span<const int> end_of_call, std::vector<unsigned char>& is_open,
                         std::span<const double> volume, std::vector<Hexahedron>& hexahedra);

 private:
  void split_call(const HexMesh& initial, const Joints& joints, std::span<const int> opened,
                  std::span<const unsigned char> is_open, std::vector<Hexahedron>& hexahedra,
                  std::vector<int>& parents);
  void find_shares(const HexMesh& initial, std::span<const double> volume, std::span<const Hexahedron> hexahedra);

  int num_initial_;
  std::vector<int> initial_;
  std::vector<double> share_;
  std::vector<int> first_, copies_;
};

/// A nodal field grows by copies of its rows `parents`.
inline void append_rows(std::span<const int> parents, PointArray& field) {
  Eigen::Index end = field.rows();
  field.conservativeResize(end + static_cast<Eigen::Index>(parents.size()), 3);
  for (const int parent : parents) field.row(end++) = field.row(parent);
}
template <class T>
void append_rows(std::span<const int> parents, std::vector<T>& field) {
  field.reserve(field.size() + parents.size());
  for (const int parent : parents) field.push_back(field[static_cast<std::size_t>(parent)]);
}

}  // namespace hexaplast
