// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/springs.hpp"

#include <algorithm>
#include <array>

#include "base/require.hpp"

namespace hexaplast {
namespace {

constexpr double kShortest = 1e-9;  // [m] below it a spring has no direction; SOFA's limit

bool pulls_or_pushes(const Spring& spring, double length) {
  return length > kShortest && (!spring.only_pulls || length > spring.rest_length);
}

}  // namespace

Springs::Springs(std::vector<Spring> springs, std::array<int, 2> num_nodes) : springs_(std::move(springs)) {
  for (const Spring& spring : springs_) {
    require_nodes("Springs", std::array{spring.a}, num_nodes[0]);
    require_nodes("Springs", std::array{spring.b}, num_nodes[1]);
  }
  stiffness_.assign(springs_.size(), Mat3::Zero());
}

double Springs::energy(const Pair<ConstPoints>& x) const {
  double sum = 0;
  for (const Spring& spring : springs_) {
    const double length = (x.second.row(spring.b) - x.first.row(spring.a)).norm(),
                 stretch = length - spring.rest_length;
    if (pulls_or_pushes(spring, length)) sum += spring.stiffness * stretch * stretch / 2;
  }
  return sum;
}

void Springs::add_force(const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) {
  require_rows("Springs::add_force", "v", v.first, x.first.rows());
  require_rows("Springs::add_force", "f", f.first, x.first.rows());
  require_rows("Springs::add_force", "v", v.second, x.second.rows());
  require_rows("Springs::add_force", "f", f.second, x.second.rows());
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& spring = springs_[i];
    stiffness_[i].setZero();
    Vec3 u = (x.second.row(spring.b) - x.first.row(spring.a)).transpose();
    const double length = u.norm();
    if (!pulls_or_pushes(spring, length)) continue;
    u /= length;
    const Vec3 relative = (v.second.row(spring.b) - v.first.row(spring.a)).transpose();
    const double tension = spring.stiffness * (length - spring.rest_length) + spring.damping * u.dot(relative);
    f.first.row(spring.a) += tension * u.transpose();
    f.second.row(spring.b) -= tension * u.transpose();
    const double across = tension / length;
    stiffness_[i] = (spring.stiffness - across) * u * u.transpose() + across * Mat3::Identity();
  }
}

void Springs::add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const {
  require_rows("Springs::add_stiffness_product", "df", df.first, dx.first.rows());
  require_rows("Springs::add_stiffness_product", "df", df.second, dx.second.rows());
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const auto [a, b] = std::pair(springs_[i].a, springs_[i].b);
    const Eigen::RowVector3d force = factor * (dx.second.row(b) - dx.first.row(a)) * stiffness_[i];
    df.first.row(a) += force;
    df.second.row(b) -= force;
  }
}

void Springs::add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const {
  const bool has_first = first_nodes[0] >= 0, has_second = first_nodes[1] >= 0;
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const int a = first_nodes[0] + springs_[i].a, b = first_nodes[1] + springs_[i].b;
    const Mat3 block = factor * stiffness_[i];
    if (has_first) A.add(a, a, -block);
    if (has_second) A.add(b, b, -block);
    if (!has_first || !has_second) continue;
    A.add(a, b, block);
    A.add(b, a, block);
  }
}

void add_anchor_forces(std::span<const int> nodes, std::span<const double> stiffness, ConstPoints rest, ConstPoints x,
                       Points f) {
  require_nodes("add_anchor_forces", nodes, x.rows());
  require_rows("add_anchor_forces", "rest", rest, x.rows());
  require_rows("add_anchor_forces", "f", f, x.rows());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    f.row(nodes[i]) -= stiffness[i] * (x.row(nodes[i]) - rest.row(nodes[i]));
}

}  // namespace hexaplast
