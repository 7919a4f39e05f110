// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// SOFA's elastic membranes of triangles (method large). The frame Q of a triangle has its first axis along the edge
/// from corner 0 to 1, its second in the plane of the triangle. In it, with corner 0 in the origin,
///
///   u_b       = Q (x_b - x_0) - Q_0 (X_b - X_0)
///   strain    = sum_b B_b u_b       B_b of the shape that the triangle has now, not of that at rest
///   f_a      -= Q^T B_a^T C strain
///   df_a     -= Q^T B_a^T C sum_b B_b Q dx_b             with Q and B held fixed
///
/// C: stiffness of the membrane times area at rest. Bending is free. Evaluation changes nothing but Q and B of the
/// latest forces. Triangles are added in their order.
class CorotatedTriangles {
 public:
  /// Of one triangle.
  struct Membrane {
    double young_modulus = 0;  ///< [Pa], times its thickness: [N/m]
    double poisson_ratio = 0;
    bool is_plane_strain = false;  ///< nothing gets thinner; otherwise plane stress
  };

  /// rest [m]; membranes: one, or one per triangle. Throws InputError for another number of them, for nodes that are
  /// not there, and for triangles without area.
  CorotatedTriangles(ConstPoints rest, std::vector<Triangle> triangles, std::span<const Membrane> membranes);

  /// f += elastic forces [N] at x; fixes what the stiffness below refers to. Throws NumericalError where a triangle has
  /// no area.
  void add_force(ConstPoints x, Points f);

  void add_stiffness_product(double factor, ConstPoints dx, Points df) const;  ///< df += factor (df/dx) dx
  void add_stiffness_blocks(double factor, BlockMatrix& K) const;              ///< K += factor df/dx

  int num_nodes() const { return num_nodes_; }

 private:
  struct Element {
    Triangle corners;
    Mat3 stiffness;                             // C [N m]
    double rest_b;                              // [m] x of corner 1 in the frame at rest
    Eigen::Vector2d rest_c;                     // [m] corner 2
    Mat3 frame;                                 // Q of the latest forces
    Eigen::Matrix<double, 3, 6> strain_matrix;  // [1/m] B of the latest forces
  };

  struct Shape {
    Mat3 frame;
    double b;           // [m] x of corner 1
    Eigen::Vector2d c;  // [m] corner 2
  };
  static Shape shape(const Triangle& corners, ConstPoints x);
  static Eigen::Matrix<double, 3, 6> strain_matrix(const Shape& shape);
  static void add(const Element& element, double factor, const Vec3& stress, Points f);

  int num_nodes_;
  std::vector<Element> elements_;
};

}  // namespace hexaplast
