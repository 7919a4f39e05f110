// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/edge_coupled_mass.hpp"

#include <algorithm>
#include <map>

#include "hexaplast/mesh/faces.hpp"

namespace hexaplast {

EdgeCoupledMass::EdgeCoupledMass(int num_nodes, std::span<const Hexahedron> hexahedra, std::span<const double> masses)
    : edges_(edges_of(hexahedra)),
      node_mass_(Eigen::VectorXd::Zero(num_nodes)),
      edge_mass_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(edges_.size()))) {
  std::map<Edge, Eigen::Index> number;
  for (std::size_t i = 0; i < edges_.size(); ++i) number[edges_[i]] = static_cast<Eigen::Index>(i);

  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    const Hexahedron& corners = hexahedra[e];
    for (const int node : corners) node_mass_[node] += masses[e] / 20;
    for (const auto& [a, b] : kEdges) {
      const auto [least, most] = std::minmax(corners[a], corners[b]);
      edge_mass_[number.at({least, most})] += masses[e] / 40;
    }
  }

  row_sums_ = node_mass_;
  for (std::size_t i = 0; i < edges_.size(); ++i)
    for (const int node : edges_[i]) row_sums_[node] += edge_mass_[static_cast<Eigen::Index>(i)];
}

void EdgeCoupledMass::add_product(double factor, ConstPoints dx, Points df) const {
  df += factor * node_mass_.asDiagonal() * dx;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto& [a, b] = edges_[i];
    const double mass = factor * edge_mass_[static_cast<Eigen::Index>(i)];
    df.row(a) += mass * dx.row(b);
    df.row(b) += mass * dx.row(a);
  }
}

void EdgeCoupledMass::add_blocks(double factor, BlockMatrix& A) const {
  for (int n = 0; n < static_cast<int>(node_mass_.size()); ++n) A.add(n, n, factor * node_mass_[n] * Mat3::Identity());
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto& [a, b] = edges_[i];
    const Mat3 block = factor * edge_mass_[static_cast<Eigen::Index>(i)] * Mat3::Identity();
    A.add(a, b, block);
    A.add(b, a, block);
  }
}

}  // namespace hexaplast
