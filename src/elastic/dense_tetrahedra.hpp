// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"
#include "hexaplast/material/material.hpp"

namespace hexaplast {

/// How the frame Q of a tetrahedron follows from its corners: its rows are three axes that turn with it.
enum class TetrahedronFrame {
  kWorld,       ///< the axes of the world: nothing turns (SOFA: small)
  kFirstEdges,  ///< along the edge from corner 0 to 1, and in the plane of corners 0, 1, 2 (SOFA: large)
  kPolar,  ///< the orthogonal factor of the edges from corner 0, a reflection where they are inverted (SOFA: polar)
};

/// SOFA's elastic tetrahedra: constant strain, one dense stiffness matrix and one frame for each.
///
///   u_b   = Q (x_b - x_0) - Q_0 (X_b - X_0)              displacement of a corner in the frame
///   f_a  -= Q^T sum_b K_ab u_b                           elastic force
///   df_a -= Q^T sum_b K_ab Q dx_b                        with the frame held fixed
///   K_ab  = |V| [ mu (g_a.g_b I + g_b g_a^T) + lambda g_a g_b^T ],   g_a the gradient of shape function a at rest
///
/// Evaluation changes nothing but the frames of the latest forces. Tetrahedra are added in their order.
class DenseTetrahedra {
 public:
  using Corners = std::array<int, 4>;

  /// rest [m]; lame: one, or one per tetrahedron. Throws InputError for another number of them, for nodes that are not
  /// there, and for flat tetrahedra. Corners may have either order.
  DenseTetrahedra(ConstPoints rest, std::vector<Corners> tetrahedra, std::span<const Lame> lame,
                  TetrahedronFrame frame = TetrahedronFrame::kFirstEdges);

  /// f += elastic forces [N] at x; fixes the frames that the stiffness below refers to.
  void add_force(ConstPoints x, Points f);

  void add_stiffness_product(double factor, ConstPoints dx, Points df) const;  ///< df += factor (df/dx) dx
  void add_stiffness_blocks(double factor, BlockMatrix& K) const;              ///< K += factor df/dx

  int num_nodes() const { return num_nodes_; }

 private:
  using Matrix12 = Eigen::Matrix<double, 12, 12>;
  using Vec12 = Eigen::Matrix<double, 12, 1>;
  struct Element {
    Corners corners;
    Matrix12 stiffness;  // [N/m]
    Vec12 local_rest;    // [m] Q_0 (X_b - X_0)
    Mat3 frame;          // Q of the latest forces
  };

  Mat3 frame(const Corners& corners, ConstPoints x) const;
  static void add(const Element& element, double factor, const Vec12& local_force, Points f);

  int num_nodes_;
  TetrahedronFrame frame_;
  std::vector<Element> elements_;
};

}  // namespace hexaplast
