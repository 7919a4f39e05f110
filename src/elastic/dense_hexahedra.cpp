// SPDX-License-Identifier: LGPL-2.1-or-later
#include "elastic/dense_hexahedra.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/require.hpp"
#include "elastic/frames.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/mesh/hex_mesh.hpp"
#include "mesh/trilinear.hpp"

namespace hexaplast {
namespace {

/// Columns: the mean edges.
Mat3 mean_edges(const ElementPoints& x) { return 2 * centre_jacobian(x); }

bool is_nearly_parallelepiped(const ElementPoints& x) {
  constexpr double kOfEdge = 1e-3;
  const Vec3 to_x = x.row(1) - x.row(0), to_z = x.row(4) - x.row(0);
  const auto closes = [&](int from, const Vec3& edge, int to) {
    return (x.row(from).transpose() + edge - x.row(to).transpose()).norm() < kOfEdge * edge.norm();
  };
  return closes(3, to_x, 2) && closes(1, to_z, 5) && closes(2, to_z, 6) && closes(3, to_z, 7);
}

/// dx/ds of the parallelepiped that the edges at corner 0 span.
Mat3 jacobian_at_corner(const ElementPoints& x) {
  Mat3 J;
  for (int d = 0; d < 3; ++d) J.col(d) = (x.row(kEdgeNeighbour[0][d]) - x.row(0)).transpose() / 2;
  return J;
}

/// K_ab of a cube, integrated by hand, as SOFA's HexahedralFEMForceField has it. J: 2 / edge along each axis. For boxes
/// that are no cubes the shears of K_ab(i, i) carry the factor of axis i instead of their own.
Mat3 cube_block(int a, int b, const Vec3& J, Lame lame) {
  const auto product = [&](int i, int j) { return kCornerSign[a][i] * kCornerSign[b][j]; };
  const auto mean = [&](int i) { return 1 + product(i, i) / 3.0; };
  Mat3 block;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int k = 3 - i - j, m = (i + 1) % 3, n = (i + 2) % 3;
      const double entry = i == j ? J[i] * J[i] *
                                        ((lame.lambda + 2 * lame.mu) * product(i, i) * mean(m) * mean(n) +
                                         lame.mu * mean(i) * (product(m, m) * mean(n) + product(n, n) * mean(m)))
                                  : J[i] * J[j] * (lame.lambda * product(i, j) + lame.mu * product(j, i)) * mean(k);
      block(i, j) = static_cast<float>(entry / 8);
    }
  return block;
}

/// K u, row by row.
std::array<double, 24> product(const std::array<double, 24 * 24>& K, const std::array<double, 24>& u) {
  std::array<double, 24> q;
  for (int row = 0; row < 24; ++row) {
    double sum = 0;
    for (int column = 0; column < 24; ++column) sum += K[24 * row + column] * u[column];
    q[row] = sum;
  }
  return q;
}

/// -factor Q^T q of each corner.
std::array<double, 24> turned_back(const Mat3& Q, const std::array<double, 24>& q, double factor) {
  std::array<double, 24> f;
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i)
      f[3 * a + i] = -factor * (Q(0, i) * q[3 * a] + Q(1, i) * q[3 * a + 1] + Q(2, i) * q[3 * a + 2]);
  return f;
}

}  // namespace

DenseHexahedra::DenseHexahedra(ConstPoints rest, std::vector<Hexahedron> hexahedra, std::span<const Lame> lame,
                               DenseHexahedraSettings settings)
    : settings_(settings),
      num_nodes_(static_cast<int>(rest.rows())),
      hexahedra_(std::move(hexahedra)),
      rest_(hexahedra_.size()),
      local_rest_(hexahedra_.size()),
      stiffness_(hexahedra_.size()),
      frames_(hexahedra_.size(), Mat3::Identity()),
      alive_(hexahedra_.size(), 1),
      first_incident_(num_nodes_ + 1, 0),
      incident_(kCorners * hexahedra_.size()),
      forces_(hexahedra_.size()),
      energies_(hexahedra_.size()) {
  for (const Hexahedron& corners : hexahedra_) require_nodes("DenseHexahedra", corners, num_nodes_);
  for (const Hexahedron& corners : hexahedra_)
    for (const int n : corners) ++first_incident_[n + 1];
  std::partial_sum(first_incident_.begin(), first_incident_.end(), first_incident_.begin());
  std::vector<int> next(first_incident_.begin(), first_incident_.end() - 1);
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    for (int a = 0; a < kCorners; ++a) incident_[next[hexahedra_[e][a]]++] = static_cast<int>(kCorners * e) + a;
    rest_[e] = gather(rest, hexahedra_[e]);
    frames_[e] = frame(e, rest_[e]);
    local_rest_[e] = rest_[e] * frames_[e].transpose();
  }
  set_lame(lame);
}

void DenseHexahedra::set_lame(std::span<const Lame> lame) {
  if (lame.size() != 1)
    require_count("DenseHexahedra", "lame", static_cast<Eigen::Index>(lame.size()),
                  static_cast<Eigen::Index>(hexahedra_.size()));
  parallel_for(static_cast<int>(hexahedra_.size()),
               [&](int e) { stiffness_[e] = stiffness(e, lame[lame.size() == 1 ? 0 : e]); });
}

void DenseHexahedra::set_alive(std::span<const unsigned char> alive) {
  require_count("DenseHexahedra::set_alive", "alive", static_cast<Eigen::Index>(alive.size()),
                static_cast<Eigen::Index>(alive_.size()));
  std::ranges::copy(alive, alive_.begin());
}

Mat3 DenseHexahedra::frame(std::size_t e, const ElementPoints& x) const {
  switch (settings_.frame) {
    case ElementFrame::kWorld:
      return Mat3::Identity();
    case ElementFrame::kMeanEdges:
      return edge_frame(mean_edges(x));
    case ElementFrame::kPolar:
      return orthogonal_factor(mean_edges(x).transpose());
    case ElementFrame::kGradient:
      return polar(Mat3(centre_jacobian(x) * centre_jacobian(rest_[e]).inverse())).R.transpose();
  }
  return Mat3::Identity();
}

DenseHexahedra::Matrix24 DenseHexahedra::stiffness(std::size_t e, Lame lame) const {
  Matrix24 K;
  K.fill(0);
  const auto add = [&](int a, int b, const Mat3& block) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) K[(3 * a + i) * 24 + 3 * b + j] += block(i, j);
  };
  if (settings_.matrix == ElementMatrix::kCube) {
    const ElementPoints& X = rest_[e];
    const Vec3 J = 2 * (X.row(6) - X.row(0)).transpose().cwiseInverse();
    const double volume = 8 * jacobian_at_corner(X).colwise().norm().prod();
    for (int a = 0; a < kCorners; ++a)
      for (int b = a; b < kCorners; ++b) {
        const Mat3 block = volume / 8 * cube_block(a, b, J, lame);
        add(a, b, block);
        if (b != a) add(b, a, block.transpose());
      }
    return K;
  }
  const ElementPoints& X = local_rest_[e];
  const bool has_one_jacobian = is_nearly_parallelepiped(X);
  const Mat3 of_corner = jacobian_at_corner(X);
  for_each_gauss_point(X, [&](const ElementPoints& dN, const Mat3& of_point) {
    const Mat3 J = has_one_jacobian ? of_corner : of_point;
    const ElementPoints g = dN * J.inverse();
    const double volume = J.determinant();
    for (int a = 0; a < kCorners; ++a)
      for (int b = 0; b < kCorners; ++b) add(a, b, stiffness_block(g.row(a), g.row(b), volume, lame));
  });
  return K;
}

/// force_of(e): forces on the corners of a hexahedron. One thread adds them as it goes; several put them down first and
/// add them in the same order then.
template <class ForceOf>
void DenseHexahedra::add_forces(const ForceOf& force_of, Points f) const {
  const int num_elements = static_cast<int>(hexahedra_.size());
  double* to = f.data();
  if (num_threads() == 1) {
    for (int e = 0; e < num_elements; ++e) {
      if (!alive_[e]) continue;
      const Vec24 force = force_of(e);
      for (int a = 0; a < kCorners; ++a)
        for (int i = 0; i < 3; ++i) to[3 * std::size_t(hexahedra_[e][a]) + i] += force[3 * a + i];
    }
    return;
  }
  parallel_for(num_elements, [&](int e) {
    if (alive_[e]) forces_[e] = force_of(e);
  });
  parallel_for(num_nodes_, [&](int n) {
    for (int k = first_incident_[n]; k < first_incident_[n + 1]; ++k) {
      const int e = incident_[k] / kCorners, a = incident_[k] % kCorners;
      if (!alive_[e]) continue;
      for (int i = 0; i < 3; ++i) to[3 * std::size_t(n) + i] += forces_[e][3 * a + i];
    }
  });
}

DenseHexahedra::Vec24 DenseHexahedra::displacement(std::size_t e, const Mat3& Q, ConstPoints x) const {
  const double* from = x.data();
  Vec24 u;
  for (int a = 0; a < kCorners; ++a) {
    const double* at = from + 3 * std::size_t(hexahedra_[e][a]);
    for (int i = 0; i < 3; ++i)
      u[3 * a + i] = Q(i, 0) * at[0] + Q(i, 1) * at[1] + Q(i, 2) * at[2] - local_rest_[e](a, i);
  }
  return u;
}

void DenseHexahedra::add_force(ConstPoints x, Points f) {
  require_rows("DenseHexahedra::add_force", "x", x, num_nodes_);
  require_rows("DenseHexahedra::add_force", "f", f, num_nodes_);
  add_forces(
      [&](int e) {
        const Mat3 Q = frames_[e] = frame(e, gather(x, hexahedra_[e]));
        return turned_back(Q, product(stiffness_[e], displacement(e, Q, x)), 1);
      },
      f);
}

void DenseHexahedra::add_stiffness_product(double factor, ConstPoints dx, Points df) const {
  require_rows("DenseHexahedra::add_stiffness_product", "dx", dx, num_nodes_);
  require_rows("DenseHexahedra::add_stiffness_product", "df", df, num_nodes_);
  const double* from = dx.data();
  add_forces(
      [&](int e) {
        const Mat3& Q = frames_[e];
        Vec24 u;
        for (int a = 0; a < kCorners; ++a) {
          const double* at = from + 3 * std::size_t(hexahedra_[e][a]);
          for (int i = 0; i < 3; ++i) u[3 * a + i] = Q(i, 0) * at[0] + Q(i, 1) * at[1] + Q(i, 2) * at[2];
        }
        return turned_back(Q, product(stiffness_[e], u), factor);
      },
      df);
}

void DenseHexahedra::add_stiffness_blocks(double factor, BlockMatrix& K) const {
  require_count("DenseHexahedra::add_stiffness_blocks", "K", K.num_nodes(), num_nodes_);
  using Block = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>, 0, Eigen::OuterStride<24>>;
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    const double present = alive_[e] ? factor : 0;  // the pattern stays when a hexahedron goes
    for (int a = 0; a < kCorners; ++a)
      for (int b = 0; b < kCorners; ++b) {
        const Block block(stiffness_[e].data() + 24 * 3 * a + 3 * b);
        K.add(hexahedra_[e][a], hexahedra_[e][b], -present * frames_[e].transpose() * block * frames_[e]);
      }
  }
}

double DenseHexahedra::energy(ConstPoints x) const {
  require_rows("DenseHexahedra::energy", "x", x, num_nodes_);
  parallel_for(static_cast<int>(hexahedra_.size()), [&](int e) {
    energies_[e] = 0;
    if (!alive_[e]) return;
    const Vec24 u = displacement(e, frame(e, gather(x, hexahedra_[e])), x);
    const Vec24 q = product(stiffness_[e], u);
    energies_[e] = std::inner_product(u.begin(), u.end(), q.begin(), 0.0) / 2;
  });
  return std::accumulate(energies_.begin(), energies_.end(), 0.0);
}

}  // namespace hexaplast
