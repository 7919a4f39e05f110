// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/dense_tetrahedra.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/require.hpp"
#include "elastic/frames.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

/// Columns: the edges from corner 0.
Mat3 edges(const DenseTetrahedra::Corners& corners, ConstPoints x) {
  Mat3 E;
  for (int b = 1; b < 4; ++b) E.col(b - 1) = (x.row(corners[b]) - x.row(corners[0])).transpose();
  return E;
}

}  // namespace

DenseTetrahedra::DenseTetrahedra(ConstPoints rest, std::vector<Corners> tetrahedra, std::span<const Lame> lame,
                                 TetrahedronFrame frame)
    : num_nodes_(static_cast<int>(rest.rows())), frame_(frame) {
  if (lame.size() != 1)
    require_count("DenseTetrahedra", "lame", static_cast<Eigen::Index>(lame.size()),
                  static_cast<Eigen::Index>(tetrahedra.size()));
  elements_.reserve(tetrahedra.size());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    const Corners& corners = tetrahedra[e];
    require_nodes("DenseTetrahedra", corners, num_nodes_);
    const Mat3 E = edges(corners, rest);
    const double volume = std::abs(E.determinant()) / 6;
    if (!(volume > 1e-12 * std::pow(E.norm(), 3))) throw InputError(fmt::format("tetrahedron {} is flat", e));
    const Mat3 Q = this->frame(corners, rest);

    // g_1, g_2, g_3 are the rows of the inverse of the edges; all four add up to 0
    Element& element = elements_.emplace_back();
    element.corners = corners;
    element.frame = Q;
    const Mat3 of_edges = (Q * E).inverse();
    Eigen::Matrix<double, 4, 3> g;
    g << -of_edges.colwise().sum(), of_edges;
    const Lame& own = lame[lame.size() == 1 ? 0 : e];
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b)
        element.stiffness.block<3, 3>(3 * a, 3 * b) =
            stiffness_block(g.row(a).transpose(), g.row(b).transpose(), volume, own);
    element.local_rest << Vec3::Zero(), (Q * E).reshaped();
  }
}

Mat3 DenseTetrahedra::frame(const Corners& corners, ConstPoints x) const {
  switch (frame_) {
    case TetrahedronFrame::kWorld:
      return Mat3::Identity();
    case TetrahedronFrame::kFirstEdges:
      return edge_frame(edges(corners, x));
    case TetrahedronFrame::kPolar:
      return orthogonal_factor(edges(corners, x).transpose());
  }
  return Mat3::Identity();
}

void DenseTetrahedra::add(const Element& element, double factor, const Vec12& local_force, Points f) {
  for (int a = 0; a < 4; ++a)
    f.row(element.corners[a]) += factor * (element.frame.transpose() * local_force.segment<3>(3 * a)).transpose();
}

void DenseTetrahedra::add_force(ConstPoints x, Points f) {
  require_rows("DenseTetrahedra::add_force", "x", x, num_nodes_);
  require_rows("DenseTetrahedra::add_force", "f", f, num_nodes_);
  for (Element& element : elements_) {
    element.frame = frame(element.corners, x);
    Vec12 u;
    u << Vec3::Zero(), (element.frame * edges(element.corners, x)).reshaped();
    add(element, -1, element.stiffness * (u - element.local_rest), f);
  }
}

void DenseTetrahedra::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  require_rows("DenseTetrahedra::add_stiffness_product", "dx", dx, num_nodes_);
  require_rows("DenseTetrahedra::add_stiffness_product", "df", df, num_nodes_);
  for (const Element& element : elements_) {
    Vec12 u;
    for (int b = 0; b < 4; ++b) u.segment<3>(3 * b) = element.frame * dx.row(element.corners[b]).transpose();
    add(element, -factor, element.stiffness * u, df);
  }
}

void DenseTetrahedra::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  require_count("DenseTetrahedra::add_stiffness_blocks", "K", K.num_nodes(), num_nodes_);
  for (const Element& element : elements_)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b)
        K.add(element.corners[a], element.corners[b],
              -factor * element.frame.transpose() * element.stiffness.block<3, 3>(3 * a, 3 * b) * element.frame);
}

}  // namespace hexaplast
