// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/corotated_triangles.hpp"

#include <fmt/format.h>

#include "base/require.hpp"
#include "elastic/frames.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

/// Stress per strain of the plane [Pa], in the order xx, yy, xy; the shear strain is that of engineers.
Mat3 plane_stiffness(const CorotatedTriangles::Membrane& membrane) {
  const double nu = membrane.poisson_ratio;
  Mat3 C = Mat3::Zero();
  if (membrane.is_plane_strain) {
    C(0, 0) = C(1, 1) = 1 - nu;
    C(2, 2) = 0.5 - nu;
  } else {
    C(0, 0) = C(1, 1) = 1;
    C(2, 2) = (1 - nu) / 2;
  }
  C(0, 1) = C(1, 0) = nu;
  return membrane.young_modulus / (membrane.is_plane_strain ? (1 + nu) * (1 - 2 * nu) : 1 - nu * nu) * C;
}

}  // namespace

CorotatedTriangles::CorotatedTriangles(ConstPoints rest, std::vector<Triangle> triangles,
                                       std::span<const Membrane> membranes)
    : num_nodes_(static_cast<int>(rest.rows())) {
  if (membranes.size() != 1)
    require_count("CorotatedTriangles", "membranes", static_cast<Eigen::Index>(membranes.size()),
                  static_cast<Eigen::Index>(triangles.size()));
  elements_.reserve(triangles.size());
  for (std::size_t e = 0; e < triangles.size(); ++e) {
    require_nodes("CorotatedTriangles", triangles[e], num_nodes_);
    const Shape at_rest = shape(triangles[e], rest);
    const double area = at_rest.b * at_rest.c[1] / 2;
    if (!(area > 1e-12 * (at_rest.b * at_rest.b + at_rest.c.squaredNorm())))
      throw InputError(fmt::format("triangle {} has no area", e));
    elements_.push_back({triangles[e], area * plane_stiffness(membranes[membranes.size() == 1 ? 0 : e]), at_rest.b,
                         at_rest.c, at_rest.frame, strain_matrix(at_rest)});
  }
}

CorotatedTriangles::Shape CorotatedTriangles::shape(const Triangle& corners, ConstPoints x) {
  const Vec3 to_b = x.row(corners[1]) - x.row(corners[0]), to_c = x.row(corners[2]) - x.row(corners[0]);
  const Mat3 Q = edge_frame((Mat3() << to_b, to_c, Vec3::Zero()).finished());
  return {Q, Q.row(0).dot(to_b), (Q * to_c).head<2>()};
}

// Gradients of the shape functions of a triangle with corners (0, 0), (b, 0), c.
Eigen::Matrix<double, 3, 6> CorotatedTriangles::strain_matrix(const Shape& shape) {
  const double b = shape.b, cx = shape.c[0], cy = shape.c[1];
  const double gradient[3][2] = {{-1 / b, (cx - b) / (b * cy)}, {1 / b, -cx / (b * cy)}, {0, 1 / cy}};
  Eigen::Matrix<double, 3, 6> B;
  for (int a = 0; a < 3; ++a) {
    B.col(2 * a) << gradient[a][0], 0, gradient[a][1];
    B.col(2 * a + 1) << 0, gradient[a][1], gradient[a][0];
  }
  return B;
}

void CorotatedTriangles::add(const Element& element, double factor, const Vec3& stress, Points f) {
  const Eigen::Matrix<double, 6, 1> local = element.strain_matrix.transpose() * stress;
  for (int a = 0; a < 3; ++a)
    f.row(element.corners[a]) +=
        factor * (element.frame.topRows<2>().transpose() * local.segment<2>(2 * a)).transpose();
}

void CorotatedTriangles::add_force(ConstPoints x, Points f) {
  require_rows("CorotatedTriangles::add_force", "x", x, num_nodes_);
  require_rows("CorotatedTriangles::add_force", "f", f, num_nodes_);
  for (Element& element : elements_) {
    const Shape now = shape(element.corners, x);
    if (!(now.b * now.c[1] > 0))
      throw NumericalError(fmt::format("triangle {} has no area any more", &element - elements_.data()));
    element.frame = now.frame;
    element.strain_matrix = strain_matrix(now);
    Eigen::Matrix<double, 6, 1> u;
    u << 0, 0, now.b - element.rest_b, 0, now.c - element.rest_c;
    add(element, -1, element.stiffness * (element.strain_matrix * u), f);
  }
}

void CorotatedTriangles::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  require_rows("CorotatedTriangles::add_stiffness_product", "dx", dx, num_nodes_);
  require_rows("CorotatedTriangles::add_stiffness_product", "df", df, num_nodes_);
  for (const Element& element : elements_) {
    Eigen::Matrix<double, 6, 1> u;
    for (int b = 0; b < 3; ++b)
      u.segment<2>(2 * b) = element.frame.topRows<2>() * dx.row(element.corners[b]).transpose();
    add(element, -factor, element.stiffness * (element.strain_matrix * u), df);
  }
}

void CorotatedTriangles::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  require_count("CorotatedTriangles::add_stiffness_blocks", "K", K.num_nodes(), num_nodes_);
  for (const Element& element : elements_) {
    const Eigen::Matrix<double, 6, 6> local =
        element.strain_matrix.transpose() * element.stiffness * element.strain_matrix;
    const Eigen::Matrix<double, 2, 3> P = element.frame.topRows<2>();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        K.add(element.corners[a], element.corners[b], -factor * P.transpose() * local.block<2, 2>(2 * a, 2 * b) * P);
  }
}

}  // namespace hexaplast
