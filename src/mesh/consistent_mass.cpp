// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/consistent_mass.hpp"

#include <cmath>
#include <vector>

#include "base/require.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "mesh/trilinear.hpp"

namespace hexaplast {
namespace {

using CornerMatrix = Eigen::Matrix<double, kCorners, kCorners>;

/// int N_a N_b dV [m^3]
CornerMatrix products_of_shapes(const ElementPoints& x) {
  CornerMatrix sum = CornerMatrix::Zero();
  const double at = 1 / std::sqrt(3.0);
  for (const auto& sign : kCornerSign) {
    const Vec3 s = at * Vec3(sign[0], sign[1], sign[2]);
    Eigen::Matrix<double, kCorners, 1> N;
    for (int a = 0; a < kCorners; ++a)
      N[a] = (1 + kCornerSign[a][0] * s[0]) * (1 + kCornerSign[a][1] * s[1]) * (1 + kCornerSign[a][2] * s[2]) / 8;
    sum += N * N.transpose() * Mat3(x.transpose() * shape_derivatives(s)).determinant();
  }
  return sum;
}

}  // namespace

ConsistentMass::ConsistentMass(ConstPoints x, std::span<const Hexahedron> hexahedra, std::span<const double> masses)
    : M_(x.rows(), x.rows()) {
  require_count("ConsistentMass", "masses", std::ssize(masses), std::ssize(hexahedra));
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(hexahedra.size() * kCorners * kCorners);
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    const Hexahedron& corners = hexahedra[e];
    require_nodes("ConsistentMass", corners, x.rows());
    CornerMatrix part = products_of_shapes(gather(x, corners));
    part *= masses[e] / part.sum();
    for (int a = 0; a < kCorners; ++a)
      for (int b = 0; b < kCorners; ++b) entries.emplace_back(corners[a], corners[b], part(a, b));
  }
  M_.setFromTriplets(entries.begin(), entries.end());
  row_sums_ = M_ * Eigen::VectorXd::Ones(x.rows());
}

template <std::size_t N>
void ConsistentMass::set_faces(int num_nodes, std::span<const std::array<int, N>> faces,
                               std::span<const double> masses) {
  require_count("ConsistentMass", "masses", std::ssize(masses), std::ssize(faces));
  constexpr double kOfCorner = 1.0 / (2 * N), kOfEdge = kOfCorner / 2;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t e = 0; e < faces.size(); ++e) {
    require_nodes("ConsistentMass", faces[e], num_nodes);
    for (std::size_t a = 0; a < N; ++a) {
      const int from = faces[e][a], to = faces[e][(a + 1) % N];
      entries.emplace_back(from, from, kOfCorner * masses[e]);
      entries.emplace_back(from, to, kOfEdge * masses[e]);
      entries.emplace_back(to, from, kOfEdge * masses[e]);
    }
  }
  M_.resize(num_nodes, num_nodes);
  M_.setFromTriplets(entries.begin(), entries.end());
  row_sums_ = M_ * Eigen::VectorXd::Ones(num_nodes);
}

ConsistentMass ConsistentMass::of_faces(int num_nodes, std::span<const Quad> quads, std::span<const double> masses) {
  ConsistentMass mass;
  mass.set_faces<4>(num_nodes, quads, masses);
  return mass;
}

ConsistentMass ConsistentMass::of_faces(int num_nodes, std::span<const Triangle> triangles,
                                        std::span<const double> masses) {
  ConsistentMass mass;
  mass.set_faces<3>(num_nodes, triangles, masses);
  return mass;
}

void ConsistentMass::add_product(double factor, ConstPoints dx, Points df) const {
  require_rows("ConsistentMass::add_product", "dx", dx, M_.rows());
  require_rows("ConsistentMass::add_product", "df", df, M_.rows());
  parallel_for(static_cast<int>(M_.outerSize()), [&](int n) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (Eigen::SparseMatrix<double>::InnerIterator entry(M_, n); entry; ++entry)  // a column is a row
      sum += entry.value() * dx.row(entry.row());
    df.row(n) += factor * sum;
  });
}

void ConsistentMass::add_blocks(double factor, BlockMatrix& A) const {
  require_count("ConsistentMass::add_blocks", "A", A.num_nodes(), M_.rows());
  for (int column = 0; column < M_.outerSize(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(M_, column); entry; ++entry)
      A.add(static_cast<int>(entry.row()), column, factor * entry.value() * Mat3::Identity());
}

}  // namespace hexaplast
