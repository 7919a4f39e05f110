// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

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

  /// Makes room: steps in which nothing tears allocate nothing.
  Tear(const Model& model, const History& history);

  std::vector<int> broken;  ///< hexahedra that have passed their limits in the latest step, ascending

  /// The faces that are to open after that step, ascending. x: num_nodes x 3 [m]; history: after it.
  std::vector<int> faces(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> steps,
                         const CornerForces& forces);

 private:
  enum Joint : unsigned char { kClosed, kOpen, kCandidate, kOpening };
  struct Side {
    double stress = 0;                     // [Pa] normal to it at present: positive where it is pulled
    double by_stress = 0, by_stretch = 0;  // [-] over the limits
  };
  /// What becomes free if a face opens together with all others that do.
  struct Release {
    bool is_at_front = false;  // of a crack that gapes
    double energy = 0;         // [J]
  };
  /// Hexahedra at a node, and which of them would still be together.
  struct Around {
    std::span<const HexMesh::Incidence> all;
    DisjointSets groups;
    int root(int e);
  };

  void find_candidates(const Model& model, const History& history);
  void find_sides(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> steps);
  void keep_greatest(const Model& model, const History& history);
  void keep_released(const Model& model, ConstPoints x, const CornerForces& forces);
  void group(const Model& model, int node);
  Release release(const Model& model, ConstPoints x, const CornerForces& forces, int face);
  bool add_opening(const Model& model, ConstPoints x, int initial_node, const Vec3& forward, int upper, int lower,
                   Vec3& opening);

  std::vector<unsigned char> joints_;       // per joint
  std::vector<int> faces_;                  // that may open, ascending
  std::vector<int> staying_;                // of them, those that set too little free
  std::vector<double> stress_;              // [Pa] per face
  std::vector<int> hexahedra_;              // on both sides of these
  std::vector<unsigned char> is_listed_;    // per element: it is one of them
  std::vector<std::array<Side, 6>> sides_;  // per element
  std::vector<double> greatest_;            // [Pa] per element: of its candidates
  Around around_;
};

}  // namespace hexaplast
