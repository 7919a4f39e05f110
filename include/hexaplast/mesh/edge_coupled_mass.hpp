// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/hexahedron.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// The mass matrix of SOFA's MeshMatrixMass: masses at nodes, coupled along edges. A hexahedron of mass m gives m/20 to
/// each corner and m/40 to each edge, so that the sum of all entries is m. (The finite element matrix would couple
/// every two corners.) It is not positive definite: nodes that move against all their neighbours have a negative
/// energy, so that only together with enough stiffness a system can be solved.
class EdgeCoupledMass {
 public:
  EdgeCoupledMass() = default;

  /// masses: of each hexahedron [kg]; their corners lie in [0, num_nodes).
  EdgeCoupledMass(int num_nodes, std::span<const Hexahedron> hexahedra, std::span<const double> masses);

  void add_product(double factor, ConstPoints dx, Points df) const;  ///< df += factor M dx
  void add_blocks(double factor, BlockMatrix& A) const;              ///< A += factor M

  /// Row sums of M [kg] per node: the lumped masses, m/8 of each hexahedron.
  const Eigen::VectorXd& row_sums() const { return row_sums_; }

 private:
  std::vector<Edge> edges_;
  Eigen::VectorXd node_mass_, edge_mass_;  // [kg]
  Eigen::VectorXd row_sums_;
};

}  // namespace hexaplast
