// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/grip.hpp"

#include <utility>

#include "hexaplast/base/require.hpp"

namespace hexaplast {

std::vector<int> nodes_near(ConstPoints x, std::span<const int> candidates, const Vec3& place, double radius) {
  require_nodes("nodes_near", candidates, x.rows());
  std::vector<int> near;
  for (const int node : candidates)
    if ((x.row(node).transpose() - place).squaredNorm() <= radius * radius) near.push_back(node);
  return near;
}

void Grip::close(std::vector<int> held, const Vec3& tool, ConstPoints x) {
  require_nodes("Grip::close", held, x.rows());
  nodes = std::move(held);
  arms.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    arms.row(static_cast<Eigen::Index>(i)) = x.row(nodes[i]) - tool.transpose();
}

void Grip::open() {
  nodes.clear();
  arms.resize(0, 3);
}

bool Grip::is_at_limit(const Vec3& lag) const { return share(stiffness) * lag.norm() > share(most_force); }

Vec3 Grip::force(const Vec3& lag) const {
  return (is_at_limit(lag) ? share(most_force) / lag.norm() : share(stiffness)) * lag;
}

Mat3 Grip::stiffness_at(const Vec3& lag) const {
  if (!is_at_limit(lag)) return -share(stiffness) * Mat3::Identity();
  const Vec3 direction = lag.normalized();
  return -share(most_force) / lag.norm() * (Mat3::Identity() - direction * direction.transpose());
}

Vec3 Grip::lag(std::size_t i, const Vec3& tool, ConstPoints x) const {
  return (tool.transpose() + arms.row(static_cast<Eigen::Index>(i)) - x.row(nodes[i])).transpose();
}

void Grip::lags_at(const Vec3& tool, ConstPoints x, PointArray& lags) const {
  require_nodes("Grip::lags_at", nodes, x.rows());
  lags.resize(arms.rows(), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i) lags.row(static_cast<Eigen::Index>(i)) = lag(i, tool, x).transpose();
}

void Grip::add_force(const Vec3& tool, ConstPoints x, Points f) const {
  require_nodes("Grip::add_force", nodes, x.rows());
  require_rows("Grip::add_force", "f", f, x.rows());
  for (std::size_t i = 0; i < nodes.size(); ++i) f.row(nodes[i]) += force(lag(i, tool, x)).transpose();
}

double Grip::energy(const Vec3& tool, ConstPoints x) const {
  require_nodes("Grip::energy", nodes, x.rows());
  const double k = share(stiffness), F = share(most_force);
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vec3 g = lag(i, tool, x);
    sum += is_at_limit(g) ? F * g.norm() - F * F / (2 * k) : k * g.squaredNorm() / 2;
  }
  return sum;
}

Vec3 Grip::total_force(ConstPoints lags) const {
  require_rows("Grip::total_force", "lags", lags, arms.rows());
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < lags.rows(); ++i) sum += force(lags.row(i).transpose());
  return sum;
}

void Grip::add_stiffness_product(ConstPoints lags, double factor, ConstPoints dx, Points df) const {
  require_rows("Grip::add_stiffness_product", "lags", lags, arms.rows());
  require_nodes("Grip::add_stiffness_product", nodes, dx.rows());
  require_rows("Grip::add_stiffness_product", "df", df, dx.rows());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    df.row(nodes[i]) +=
        factor * dx.row(nodes[i]) * stiffness_at(lags.row(static_cast<Eigen::Index>(i)).transpose());  // symmetric
}

void Grip::add_stiffness_blocks(ConstPoints lags, double factor, BlockMatrix& A) const {
  require_rows("Grip::add_stiffness_blocks", "lags", lags, arms.rows());
  require_nodes("Grip::add_stiffness_blocks", nodes, A.num_nodes());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    A.add(nodes[i], nodes[i], factor * stiffness_at(lags.row(static_cast<Eigen::Index>(i)).transpose()));
}

bool Grip::add_stiffness_diagonal(ConstPoints lags, double factor, Points diagonal) const {
  require_rows("Grip::add_stiffness_diagonal", "lags", lags, arms.rows());
  require_nodes("Grip::add_stiffness_diagonal", nodes, diagonal.rows());
  for (Eigen::Index i = 0; i < lags.rows(); ++i)
    if (is_at_limit(lags.row(i).transpose())) return false;
  for (const int node : nodes) diagonal.row(node).array() -= factor * share(stiffness);
  return true;
}

Vec3 Grip::add_damping_force(const Vec3& tool_velocity, ConstPoints v, Points f) const {
  require_nodes("Grip::add_damping_force", nodes, v.rows());
  require_rows("Grip::add_damping_force", "f", f, v.rows());
  Vec3 sum = Vec3::Zero();
  for (const int node : nodes) {
    const Vec3 force = share(damping) * (tool_velocity - v.row(node).transpose());
    f.row(node) += force.transpose();
    sum += force;
  }
  return sum;
}

void Grip::add_damping_product(double factor, ConstPoints dx, Points df) const {
  require_nodes("Grip::add_damping_product", nodes, dx.rows());
  require_rows("Grip::add_damping_product", "df", df, dx.rows());
  for (const int node : nodes) df.row(node) -= factor * share(damping) * dx.row(node);
}

void Grip::add_damping_blocks(double factor, BlockMatrix& A) const {
  require_nodes("Grip::add_damping_blocks", nodes, A.num_nodes());
  for (const int node : nodes) A.add(node, node, -factor * share(damping) * Mat3::Identity());
}

void Grip::add_damping_diagonal(double factor, Points diagonal) const {
  require_nodes("Grip::add_damping_diagonal", nodes, diagonal.rows());
  for (const int node : nodes) diagonal.row(node).array() -= factor * share(damping);
}

}  // namespace hexaplast
