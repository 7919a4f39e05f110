// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/material/material.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::baselines {

/// A baseline for comparison: the hexahedra of SOFA's HexahedronFEMForceField, with which the figures of `hexaplast
/// bench` are compared in the same process. Each has one dense stiffness matrix K, by 2x2x2 Gauss points at rest, and
/// one rotation R, that of the deformation gradient at the centre, as in the published element:
///
///   f_a  -= R sum_b K_ab (R^T x_b - X_b)        df_a -= R sum_b K_ab R^T dx_b
///
/// Elements are walked one after the other and add to their nodes; implicit Euler without damping, plain conjugate
/// gradients with one pass over memory per vector operation. One thread, the compiler's base instruction set.
class DensePeer {
 public:
  /// lame: per element; masses [kg]: per node; nodes of `fixed` do not move.
  DensePeer(const HexMesh& mesh, const std::vector<Lame>& lame, Eigen::VectorXd masses, std::vector<int> fixed);

  /// Finds the rotations at x; f += elastic forces [N].
  void add_force(ConstPoints x, Points f);

  /// df -= factor K dx with those rotations.
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const;

  /// When the conjugate gradients end: after `iterations`, or when the relative residual or `is_enough` says so.
  struct Stop {
    int iterations = 25;
    double tolerance = 0;                                ///< on |r| / |b|
    std::function<bool(ConstPoints dv)> is_enough = {};  ///< asked after each iteration where it is given
  };

  /// One step of dt [s] under gravity [m/s^2] from x and v; dv: the velocity increment that was found.
  SolveReport step(const Vec3& gravity, double dt, const Stop& stop, Points x, Points v, Points dv);

 private:
  using Vec24 = std::array<double, 24>;          // corner by corner
  using Matrix24 = std::array<double, 24 * 24>;  // row by row

  static Matrix24 stiffness(const ElementPoints& X, Lame lame);
  template <class ForceOf>
  void add_forces(const ForceOf& force_of, Points f) const;
  void project(PointArray& field) const;

  std::vector<Hexahedron> hexahedra_;
  std::vector<ElementPoints> rest_;  // [m] X
  std::vector<Matrix24> stiffness_;  // [N/m] K
  std::vector<Mat3> frames_;         // R^T of the latest forces
  Eigen::VectorXd masses_;
  std::vector<int> fixed_;
  PointArray residual_, direction_, product_;
};

}  // namespace hexaplast::baselines
