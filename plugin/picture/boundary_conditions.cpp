// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/boundary_conditions.hpp"

#include <array>
#include <cmath>
#include <map>

#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::output {
namespace {

constexpr double kRounding = 1e-6;      // of the strongest load: what is left of loads without pulls
constexpr double kBetweenLoads = 0.05;  // of the diagonal: of denser loads the strongest are shown

}  // namespace

Vec3 Instrument::acts_at(ConstPoints positions) const {
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  for (std::size_t k = 0; k < nodes.size() && !shape_triangles.empty(); ++k) {
    const double size = forces.row(static_cast<Eigen::Index>(k)).norm();
    sum += size * positions.row(nodes[k]).transpose();
    weight += size;
  }
  return weight > 0 ? Vec3(sum / weight) : place;
}

std::vector<NodalLoad> shown_loads(const HexMesh& mesh, std::span<const unsigned char> alive,
                                   const BoundaryConditions& conditions) {
  if (conditions.loads.rows() == 0) return {};
  PointArray forces = conditions.loads;
  for (const Instrument& instrument : conditions.instruments)
    for (std::size_t k = 0; k < instrument.nodes.size(); ++k)
      forces.row(instrument.nodes[k]) -= instrument.forces.row(static_cast<Eigen::Index>(k));
  const PointArray& original = mesh.positions();
  const double across = kBetweenLoads * (original.colwise().maxCoeff() - original.colwise().minCoeff()).norm();
  const double min = kRounding * conditions.loads.rowwise().norm().maxCoeff();
  std::map<std::array<int, 3>, int> strongest;  // node by neighbourhood
  for (int node = 0; node < mesh.num_nodes(); ++node) {
    if (!(forces.row(node).norm() > min)) continue;
    if (!alive.empty() && !hold_together(mesh, alive, {&node, 1})) continue;
    std::array<int, 3> cell;
    for (int axis = 0; axis < 3; ++axis) cell[axis] = static_cast<int>(std::floor(original(node, axis) / across));
    const auto [found, is_first] = strongest.emplace(cell, node);
    if (!is_first && forces.row(node).norm() > 1.001 * forces.row(found->second).norm()) found->second = node;
  }
  std::vector<NodalLoad> loads;
  for (const auto& [cell, node] : strongest) loads.push_back({node, forces.row(node).transpose()});
  return loads;
}

}  // namespace hexaplast::output
