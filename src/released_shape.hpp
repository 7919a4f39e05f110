// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/body.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// How many linear systems a released shape has taken, and what is left.
struct ReleaseReport {
  int solves = 0;
  double change = 0;       ///< [m] largest of a node, in the last solve
  bool converged = false;  ///< the change is below the tolerance
};

/// What isolated rest shapes have in place of plastic rest positions: the equilibrium of the body without loads and
/// supports, its plastic deformation held. For output alone: found when it is asked for.   theory.md section 5.9
class ReleasedShape {
 public:
  ReleasedShape() = default;
  ReleasedShape(const ReleasedShape&) {}  // a copy of a body finds its own
  ReleasedShape& operator=(const ReleasedShape&) = delete;

  /// [m] num_nodes x 3, of a history in which something has flowed. Each connected part lies on its initial positions
  /// as well as a rigid motion can lay it; nodes without hexahedron are where they were.
  const PointArray& positions(const Model& model, const History& history);

  const ReleaseReport& report() const { return report_; }  ///< of the latest one

 private:
  long version_ = -1;  // History::version that the positions belong to
  PointArray positions_ = PointArray(0, 3);
  ReleaseReport report_;
};

}  // namespace hexaplast
