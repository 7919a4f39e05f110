// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/SparseCore>
#include <span>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/hexahedron.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// The finite element mass matrix of trilinear hexahedra, by 2x2x2 Gauss points:
///
///   M_ab = sum of m / V int N_a N_b dV     for a hexahedron of mass m [kg] and volume V [m^3]
///
/// Symmetric and positive definite on nodes that belong to a hexahedron; the entries of each hexahedron add up to m.
class ConsistentMass {
 public:
  ConsistentMass() = default;

  /// x: num_nodes x 3 [m]; masses: of each hexahedron [kg]; their corners are rows of x. All three throw InputError for
  /// other sizes.
  ConsistentMass(ConstPoints x, std::span<const Hexahedron> hexahedra, std::span<const double> masses);

  void add_product(double factor, ConstPoints dx, Points df) const;  ///< df += factor M dx
  void add_blocks(double factor, BlockMatrix& A) const;              ///< A += factor M

  /// Sums of the rows [kg]: what gravity acts on, so that a free body falls without deforming.
  const Eigen::VectorXd& row_sums() const { return row_sums_; }

 private:
  Eigen::SparseMatrix<double> M_;
  Eigen::VectorXd row_sums_;
};

}  // namespace hexaplast
