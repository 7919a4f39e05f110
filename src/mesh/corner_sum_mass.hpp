// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// The mass matrix that SOFA's hexahedra with mass have. Every two corners of a hexahedron of mass m [kg] share the
/// same entry, which is that of a corner with itself:
///
///   M_ab = 8/27 m     for all corners a, b of a hexahedron
///
/// A hexahedron resists the sum of the accelerations of its corners alone, and a body that moves as a whole has the
/// inertia of 64 * 8/27 = 18.96 times its mass. Gravity acts on an eighth of m at each corner.
class CornerSumMass {
 public:
  CornerSumMass() = default;

  /// masses: of each hexahedron [kg]. is_lumped: the sum of each row on the diagonal. Throws InputError for another
  /// number of them, and for corners that are not among the nodes.
  CornerSumMass(int num_nodes, std::span<const Hexahedron> hexahedra, std::span<const double> masses, bool is_lumped);

  void add_product(double factor, ConstPoints dx, Points df) const;  ///< df += factor M dx
  void add_blocks(double factor, BlockMatrix& A) const;              ///< A += factor M

  bool is_lumped() const { return is_lumped_; }
  const Eigen::VectorXd& lumped() const { return lumped_; }    ///< [kg] sums of the rows
  const Eigen::VectorXd& weighed() const { return weighed_; }  ///< [kg] what gravity acts on

 private:
  bool is_lumped_ = false;
  std::vector<Hexahedron> hexahedra_;
  std::vector<double> entries_;  // [kg] M_ab of each hexahedron
  Eigen::VectorXd lumped_, weighed_;
};

}  // namespace hexaplast
