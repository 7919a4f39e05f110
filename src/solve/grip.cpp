// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/grip.hpp"

#include <numeric>
#include <utility>

#include "base/require.hpp"

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
  weights.clear();
  arms.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    arms.row(static_cast<Eigen::Index>(i)) = x.row(nodes[i]) - tool.transpose();
}

void Grip::open() {
  nodes.clear();
  weights.clear();
  arms.resize(0, 3);
}

void Grip::share_out(std::span<const double> share_of_node) {
  require_nodes("Grip::share_out", nodes, std::ssize(share_of_node));
  weights.clear();
  for (const int node : nodes) weights.push_back(share_of_node[node]);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
}

double Grip::part(double of_all, std::size_t i) const {
  return weights.empty() ? of_all / static_cast<double>(nodes.size()) : of_all * weights[i];
}

bool Grip::is_at_limit(const Vec3& elongation, std::size_t i) const {
  return part(stiffness, i) * elongation.norm() > part(max_force, i);
}

Vec3 Grip::force(const Vec3& elongation, std::size_t i) const {
  return (is_at_limit(elongation, i) ? part(max_force, i) / elongation.norm() : part(stiffness, i)) * elongation;
}

Mat3 Grip::stiffness_at(const Vec3& elongation, std::size_t i) const {
  if (!is_at_limit(elongation, i)) return -part(stiffness, i) * Mat3::Identity();
  const Vec3 direction = elongation.normalized();
  return -part(max_force, i) / elongation.norm() * (Mat3::Identity() - direction * direction.transpose());
}

Vec3 Grip::elongation(std::size_t i, const Vec3& tool, ConstPoints x) const {
  return (tool.transpose() + arms.row(static_cast<Eigen::Index>(i)) - x.row(nodes[i])).transpose();
}

void Grip::elongations_at(const Vec3& tool, ConstPoints x, PointArray& elongations) const {
  require_nodes("Grip::elongations_at", nodes, x.rows());
  elongations.resize(arms.rows(), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    elongations.row(static_cast<Eigen::Index>(i)) = elongation(i, tool, x).transpose();
}

void Grip::add_force(const Vec3& tool, ConstPoints x, Points f) const {
  require_nodes("Grip::add_force", nodes, x.rows());
  require_rows("Grip::add_force", "f", f, x.rows());
  for (std::size_t i = 0; i < nodes.size(); ++i) f.row(nodes[i]) += force(elongation(i, tool, x), i).transpose();
}

double Grip::energy(const Vec3& tool, ConstPoints x) const {
  require_nodes("Grip::energy", nodes, x.rows());
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double k = part(stiffness, i), F = part(max_force, i);
    const Vec3 g = elongation(i, tool, x);
    sum += is_at_limit(g, i) ? F * g.norm() - F * F / (2 * k) : k * g.squaredNorm() / 2;
  }
  return sum;
}

Vec3 Grip::total_force(ConstPoints elongations) const {
  require_rows("Grip::total_force", "elongations", elongations, arms.rows());
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < elongations.rows(); ++i)
    sum += force(elongations.row(i).transpose(), static_cast<std::size_t>(i));
  return sum;
}

Vec3 Grip::total_moment(ConstPoints elongations) const {
  require_rows("Grip::total_moment", "elongations", elongations, arms.rows());
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < elongations.rows(); ++i) {
    const Vec3 g = elongations.row(i).transpose();
    sum += (arms.row(i).transpose() - g).cross(force(g, static_cast<std::size_t>(i)));
  }
  return sum;
}

Vec3 Grip::damping_moment(ConstPoints elongations, const Vec3& tool_velocity, ConstPoints v) const {
  require_rows("Grip::damping_moment", "elongations", elongations, arms.rows());
  require_nodes("Grip::damping_moment", nodes, v.rows());
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Vec3 from_tool = (arms.row(row) - elongations.row(row)).transpose();
    sum += from_tool.cross(part(damping, i) * (tool_velocity - v.row(nodes[i]).transpose()));
  }
  return sum;
}

void Grip::add_stiffness_product(ConstPoints elongations, double factor, ConstPoints dx, Points df) const {
  require_rows("Grip::add_stiffness_product", "elongations", elongations, arms.rows());
  require_nodes("Grip::add_stiffness_product", nodes, dx.rows());
  require_rows("Grip::add_stiffness_product", "df", df, dx.rows());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    df.row(nodes[i]) += factor * dx.row(nodes[i]) *
                        stiffness_at(elongations.row(static_cast<Eigen::Index>(i)).transpose(), i);  // symmetric
}

void Grip::add_stiffness_blocks(ConstPoints elongations, double factor, BlockMatrix& A) const {
  require_rows("Grip::add_stiffness_blocks", "elongations", elongations, arms.rows());
  require_nodes("Grip::add_stiffness_blocks", nodes, A.num_nodes());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    A.add(nodes[i], nodes[i], factor * stiffness_at(elongations.row(static_cast<Eigen::Index>(i)).transpose(), i));
}

bool Grip::add_stiffness_diagonal(ConstPoints elongations, double factor, Points diagonal) const {
  require_rows("Grip::add_stiffness_diagonal", "elongations", elongations, arms.rows());
  require_nodes("Grip::add_stiffness_diagonal", nodes, diagonal.rows());
  for (Eigen::Index i = 0; i < elongations.rows(); ++i)
    if (is_at_limit(elongations.row(i).transpose(), static_cast<std::size_t>(i))) return false;
  for (std::size_t i = 0; i < nodes.size(); ++i) diagonal.row(nodes[i]).array() -= factor * part(stiffness, i);
  return true;
}

Vec3 Grip::add_damping_force(const Vec3& tool_velocity, ConstPoints v, Points f) const {
  require_nodes("Grip::add_damping_force", nodes, v.rows());
  require_rows("Grip::add_damping_force", "f", f, v.rows());
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Vec3 force = part(damping, i) * (tool_velocity - v.row(nodes[i]).transpose());
    f.row(nodes[i]) += force.transpose();
    sum += force;
  }
  return sum;
}

void Grip::add_damping_product(double factor, ConstPoints dx, Points df) const {
  require_nodes("Grip::add_damping_product", nodes, dx.rows());
  require_rows("Grip::add_damping_product", "df", df, dx.rows());
  for (std::size_t i = 0; i < nodes.size(); ++i) df.row(nodes[i]) -= factor * part(damping, i) * dx.row(nodes[i]);
}

void Grip::add_damping_blocks(double factor, BlockMatrix& A) const {
  require_nodes("Grip::add_damping_blocks", nodes, A.num_nodes());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    A.add(nodes[i], nodes[i], -factor * part(damping, i) * Mat3::Identity());
}

void Grip::add_damping_diagonal(double factor, Points diagonal) const {
  require_nodes("Grip::add_damping_diagonal", nodes, diagonal.rows());
  for (std::size_t i = 0; i < nodes.size(); ++i) diagonal.row(nodes[i]).array() -= factor * part(damping, i);
}

}  // namespace hexaplast
