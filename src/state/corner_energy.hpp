// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// Ratios of the Jacobians of the corners, current against plastic rest.                                      eq. E22
CornerValues corner_ratios(const ElementPoints& plastic_rest, const ElementPoints& current);

/// The corner energy of isolated rest shapes, which keeps corners from folding.                  theory.md section 3.3
///
///   E_K = sum_i kappa_K mu V_e/16 max(0, d_K - d_i)^2,   kappa_K = 5,   d_K = 0.3                          (eq. E32)
///
/// A function of positions alone, so that energy is conserved and forces and moments sum to zero.
class CornerEnergy {
 public:
  static constexpr double kFrom = 0.3;    ///< [-] d_K
  static constexpr double kStrength = 5;  ///< [-] kappa_K

  void clear() { corners_.clear(); }

  /// The thin corners of one element of initial volume [m^3] and shear modulus mu [Pa]; positions [m].
  void add(const Hexahedron& nodes, double mu, double volume, const ElementPoints& plastic_rest,
           const ElementPoints& current);

  bool acts() const { return !corners_.empty(); }
  double energy() const;  ///< [J]

  /// f += forces [N].
  void add_force(Points f) const;

  /// Fp += factor W p, W the Gauss-Newton part of the Hessian: positive semi-definite.                       eq. E33
  void add_product(double factor, ConstPoints p, Points Fp) const;

  /// diagonal += factor diag(W).
  void add_diagonal(double factor, Points diagonal) const;

  /// K += factor W.
  void add_blocks(double factor, BlockMatrix& K) const;

 private:
  struct Corner {
    std::array<int, 4> nodes;                            // its own, and those at the other ends of its edges
    Eigen::Matrix<double, 4, 3, Eigen::RowMajor> slope;  // [1/m] of d
    double stiffness;                                    // [J] kappa_K mu V/8
    double missing;                                      // [-] d_K - d > 0
  };
  std::vector<Corner> corners_;
};

}  // namespace hexaplast
