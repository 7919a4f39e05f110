// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <vector>

#include "hexaplast/layout/linear_system.hpp"
#include "hexaplast/material/material.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::baselines {

/// A baseline for comparison, written for it and not part of the library: corotational hexahedra in the layout of
/// SOFA's HexahedronFEMForceField, with which the figures of `hexaplast bench` are compared in the same process.
///
///   K_e   dense 24x24 in double precision per element, computed once in the rest shape (2x2x2 Gauss points)
///   R_e   one rotation per element: polar decomposition of the deformation gradient at the centre
///   f_a   -= R_e sum_b K_ab (R_e^T x_b - X_b)                                           elastic force
///   df_a  -= R_e sum_b K_ab R_e^T dx_b                                                  eight rotations in, eight out
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

  /// The stiffness matrices alone, per element.
  static constexpr std::size_t kBytesPerElement = 24 * 24 * sizeof(double);

 private:
  using Matrix24 = std::array<double, 24 * 24>;

  void project(PointArray& field) const;

  std::vector<Hexahedron> hexahedra_;
  std::vector<Matrix24> stiffness_;             // row-major, corner by corner
  std::vector<ElementPoints> rest_;             // [m]
  std::vector<ElementPoints> centre_gradient_;  // [1/m] gradients of the shape functions at the centre
  std::vector<Mat3> rotation_;
  Eigen::VectorXd masses_;
  std::vector<int> fixed_;
  PointArray residual_, direction_, product_;
};

}  // namespace hexaplast::baselines
