// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"
#include "hexaplast/material/material.hpp"

namespace hexaplast {

/// How the frame Q of a hexahedron follows from its corners: its rows are three axes that turn with the hexahedron. The
/// mean edge of a direction is the mean of the four edges along it.
enum class ElementFrame {
  kWorld,      ///< the axes of the world: nothing turns (SOFA: small)
  kMeanEdges,  ///< along the mean edge x, and in the plane of the mean edges x and y (SOFA: large)
  kPolar,      ///< the orthogonal factor of the mean edges, a reflection where they are inverted (SOFA: polar)
  kGradient,   ///< the rotation of the deformation gradient at the centre; the world's axes at rest
};

/// Where the stiffness matrix of a hexahedron comes from.
enum class ElementMatrix {
  kIntegrated,  ///< 2x2x2 Gauss points, in the frame at rest; with the edges at corner 0 where the hexahedron is within
                ///< a thousandth of a parallelepiped
  kCube,        ///< the exact integral over a cube along the world's axes, rounded to single precision
};

struct DenseHexahedraSettings {
  ElementFrame frame = ElementFrame::kMeanEdges;
  ElementMatrix matrix = ElementMatrix::kIntegrated;
};

/// SOFA's elastic hexahedra: one dense stiffness matrix and one frame for each.
///
///   u_b   = Q x_b - Q_0 X_b                              displacement of a corner in the frame
///   f_a  -= Q^T sum_b K_ab u_b                           elastic force
///   df_a -= Q^T sum_b K_ab Q dx_b                        with the frame held fixed
///   E     = 1/2 sum_ab u_a . K_ab u_b
///
/// Forces are the gradient of E where frames do not turn (ElementFrame::kWorld); where they turn, the work of turning
/// is left out, as in SOFA. Evaluation changes nothing but the frames of the latest forces. A node adds its hexahedra
/// in their order: the same bits for any number of threads. No call but the constructor allocates.
class DenseHexahedra {
 public:
  /// rest [m]; lame: one, or one per hexahedron. Throws InputError for another number of them, and for nodes that are
  /// not there.
  DenseHexahedra(ConstPoints rest, std::vector<Hexahedron> hexahedra, std::span<const Lame> lame,
                 DenseHexahedraSettings settings = {});

  /// Other materials for the same hexahedra.
  void set_lame(std::span<const Lame> lame);

  /// f += elastic forces [N] at x; fixes the frames that the stiffness below refers to.
  void add_force(ConstPoints x, Points f);

  /// df += factor (df/dx) dx.
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const;

  /// K += factor df/dx.
  void add_stiffness_blocks(double factor, BlockMatrix& K) const;

  /// [J] at any positions.
  double energy(ConstPoints x) const;

  /// Which hexahedra are there: one entry for each, 0 for those that make no force.
  void set_alive(std::span<const unsigned char> alive);

  int num_nodes() const { return num_nodes_; }
  const std::vector<Hexahedron>& hexahedra() const { return hexahedra_; }

  /// The stiffness matrices alone.
  static constexpr std::size_t kBytesPerElement = 24 * 24 * sizeof(double);

 private:
  using Vec24 = std::array<double, 24>;          // corner by corner
  using Matrix24 = std::array<double, 24 * 24>;  // row by row

  Mat3 frame(std::size_t e, const ElementPoints& x) const;
  Matrix24 stiffness(std::size_t e, Lame lame) const;
  Vec24 displacement(std::size_t e, const Mat3& Q, ConstPoints x) const;
  template <class ForceOf>
  void add_forces(const ForceOf& force_of, Points f) const;

  DenseHexahedraSettings settings_;
  int num_nodes_;
  std::vector<Hexahedron> hexahedra_;
  std::vector<ElementPoints> rest_;        // [m] X
  std::vector<ElementPoints> local_rest_;  // [m] Q_0 X
  std::vector<Matrix24> stiffness_;        // [N/m]
  std::vector<Mat3> frames_;               // Q of the latest forces
  std::vector<unsigned char> alive_;

  std::vector<int> first_incident_, incident_;  // per node: 8 e + corner, ascending
  mutable std::vector<Vec24> forces_;           // of each hexahedron on its corners, where several threads make them
  mutable std::vector<double> energies_;
};

}  // namespace hexaplast
