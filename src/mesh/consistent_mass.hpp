// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <span>

#include "hexaplast/base/block_matrix.hpp"
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

  /// Of a membrane, as SOFA's MeshMatrixMass has it: a face of mass m gives each corner m/8 and each of its edges m/16
  /// of quads, m/6 and m/12 of triangles. For triangles this is the finite element matrix. Sizes as above.
  static ConsistentMass of_faces(int num_nodes, std::span<const Quad> quads, std::span<const double> masses);
  static ConsistentMass of_faces(int num_nodes, std::span<const Triangle> triangles, std::span<const double> masses);

  void add_product(double factor, ConstPoints dx, Points df) const;  ///< df += factor M dx
  void add_blocks(double factor, BlockMatrix& A) const;              ///< A += factor M

  /// Sums of the rows [kg]: what gravity acts on, so that a free body falls without deforming.
  const Eigen::VectorXd& row_sums() const { return row_sums_; }

 private:
  template <std::size_t N>
  void set_faces(int num_nodes, std::span<const std::array<int, N>> faces, std::span<const double> masses);

  Eigen::SparseMatrix<double> M_;
  Eigen::VectorXd row_sums_;
};

}  // namespace hexaplast
