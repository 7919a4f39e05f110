// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh/corner_sum_mass.hpp"

#include "base/require.hpp"

namespace hexaplast {

CornerSumMass::CornerSumMass(int num_nodes, std::span<const Hexahedron> hexahedra, std::span<const double> masses,
                             bool is_lumped)
    : is_lumped_(is_lumped),
      hexahedra_(hexahedra.begin(), hexahedra.end()),
      lumped_(Eigen::VectorXd::Zero(num_nodes)),
      weighed_(Eigen::VectorXd::Zero(num_nodes)) {
  require_count("CornerSumMass", "masses", std::ssize(masses), std::ssize(hexahedra));
  entries_.reserve(masses.size());
  for (std::size_t e = 0; e < masses.size(); ++e) {
    require_nodes("CornerSumMass", hexahedra_[e], num_nodes);
    entries_.push_back(8.0 / 27 * masses[e]);
    for (const int n : hexahedra_[e]) {
      lumped_[n] += kCorners * entries_[e];
      weighed_[n] += masses[e] / kCorners;
    }
  }
}

void CornerSumMass::add_product(double factor, ConstPoints dx, Points df) const {
  require_rows("CornerSumMass::add_product", "dx", dx, lumped_.size());
  require_rows("CornerSumMass::add_product", "df", df, lumped_.size());
  if (is_lumped_) {
    df += factor * lumped_.asDiagonal() * dx;
    return;
  }
  for (std::size_t e = 0; e < hexahedra_.size(); ++e) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (const int n : hexahedra_[e]) sum += dx.row(n);
    sum *= factor * entries_[e];
    for (const int n : hexahedra_[e]) df.row(n) += sum;
  }
}

void CornerSumMass::add_blocks(double factor, BlockMatrix& A) const {
  require_count("CornerSumMass::add_blocks", "A", A.num_nodes(), lumped_.size());
  if (is_lumped_) {
    for (int n = 0; n < static_cast<int>(lumped_.size()); ++n) A.add(n, n, factor * lumped_[n] * Mat3::Identity());
    return;
  }
  for (std::size_t e = 0; e < hexahedra_.size(); ++e)
    for (const int a : hexahedra_[e])
      for (const int b : hexahedra_[e]) A.add(a, b, factor * entries_[e] * Mat3::Identity());
}

}  // namespace hexaplast
