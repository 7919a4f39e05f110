// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/disjoint_sets.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// Where plastic steps tear a body of Fracture::kFace.                                           theory.md section 10
class Tear {
 public:
  /// [N] elastic ones at present, of a hexahedron.
  using CornerForces = std::function<ElementPoints(int element)>;

  /// Makes room: steps in which nothing breaks allocate nothing.
  explicit Tear(const Model& model);

  std::vector<int> broken;  ///< hexahedra that have passed their limits in the latest step, ascending

  /// The faces that are to open after that step, ascending. x: num_nodes x 3 [m]; history: after it.
  std::vector<int> faces(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> steps,
                         const CornerForces& forces);

 private:
  enum Joint : unsigned char { kClosed, kOpen, kListed, kOpening };
  struct Side {
    double stress = 0;                     // [Pa] normal to it at present: positive where it is pulled
    double by_stress = 0, by_stretch = 0;  // [-] over the limits
  };
  /// What becomes of a crack if a face opens together with all others that do.
  struct Release {
    bool is_at_front = false;  // it has nodes at which a crack ends that gapes
    bool splits = false;       // one of them
    double energy = 0;         // [J] that becomes free
  };
  /// Hexahedra at a node, and which of them would still be together.
  struct Around {
    std::span<const HexMesh::Incidence> all;
    DisjointSets groups;
    bool has(int e) const { return std::ranges::find(all, e, &HexMesh::Incidence::element) != all.end(); }
    int root(int e) {
      return groups.root(static_cast<int>(std::ranges::find(all, e, &HexMesh::Incidence::element) - all.begin()));
    }
    bool are_together(std::span<const int> hexahedra) {
      return std::ranges::all_of(hexahedra, [&](int e) { return root(e) == root(hexahedra.front()); });
    }
    /// 1: e is together with the first of these hexahedra, -1: with another, 0: with none.
    int side(std::span<const int> of, int e) {
      const auto found = std::ranges::find(of, root(e), [&](int other) { return root(other); });
      return found == of.end() ? 0 : found == of.begin() ? 1 : -1;
    }
  };

  bool holds(const Model& model, int joint) const;
  void list(const History& history, int element);
  void find_candidates(const Model& model, const History& history);
  void find_sides(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> steps);
  double normal_stress(const Model& model, const History& history, int joint) const;
  bool passes(const Model& model, const History& history, int joint) const;
  bool is_greatest(const Model& model, const History& history, int joint) const;
  void keep_advancing(const Model& model, ConstPoints x, const CornerForces& forces);
  bool advances(const Model& model, ConstPoints x, const CornerForces& forces, int joint);
  void group(const Model& model, int node);
  Release release(const Model& model, ConstPoints x, const CornerForces& forces, int joint);
  bool find_opening(const Model& model, ConstPoints x, int initial_node, const Vec3& forward, std::span<const int> held,
                    Vec3& opening);

  std::vector<unsigned char> joints_;       // per joint
  std::vector<int> faces_;                  // that may open, ascending
  std::vector<int> staying_;                // of them, those that do not
  std::vector<int> hexahedra_;              // whose sides are known
  std::vector<unsigned char> is_listed_;    // per element: it is one of them
  std::vector<std::array<Side, 6>> sides_;  // per element
  Around around_;
};

}  // namespace hexaplast
