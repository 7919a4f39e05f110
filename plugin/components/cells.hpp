// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/interfaces.hpp"

/// Cells and points between scene and core: flat lists of numbers there, groups of N nodes and rows here.
namespace hexaplast::components {

/// An attribute of whole numbers as cells. Rejects the scene when the numbers do not form groups of N, or a node is not
/// below `num_nodes`.
template <std::size_t N>
std::vector<std::array<int, N>> cells_of(scene::Object& owner, std::string_view attribute, int num_nodes) {
  const std::vector<int> nodes = owner.indices(attribute, num_nodes);
  if (nodes.size() % N != 0)
    owner.reject(attribute, std::to_string(nodes.size()) + " numbers given, must be groups of " + std::to_string(N));
  std::vector<std::array<int, N>> cells(nodes.size() / N);
  for (std::size_t i = 0; i < nodes.size(); ++i) cells[i / N][i % N] = nodes[i];
  return cells;
}

/// The nodes of cells, one after the other.
template <std::size_t N>
std::vector<std::int64_t> flattened(std::span<const std::array<int, N>> cells) {
  std::vector<std::int64_t> nodes;
  nodes.reserve(N * cells.size());
  for (const auto& cell : cells) nodes.insert(nodes.end(), cell.begin(), cell.end());
  return nodes;
}

/// The coordinates of points, one after the other.
inline std::vector<double> flattened(const PointArray& points) {
  return {points.data(), points.data() + points.size()};
}

/// The hexahedra of a topology, for a component that works on a state of `num_nodes` nodes. Rejects the scene when
/// there are none, when the topology has another number of nodes, or when a hexahedron has a node that the state has
/// not.
const std::vector<Hexahedron>& hexahedra_on(scene::Component& component, scene::Topology& topology, int num_nodes);

/// The hexahedra of a topology with the corners that they have at present, where nodes of a state have split; the
/// topology keeps those of the beginning.
const std::vector<Hexahedron>& present_hexahedra(const std::vector<Hexahedron>& of_topology,
                                                 const scene::MechanicalState& state);

/// Why that cannot be, for FollowsNodes::cannot_follow: the hexahedra are not those of the body. Empty: they are.
std::string are_others(const std::vector<Hexahedron>& of_topology, const Body& body);

/// Rejects the scene when the topology has nodes, and another number of them than the state.
void require_same_nodes(scene::Component& component, scene::Topology& topology, int num_nodes);

}  // namespace hexaplast::components
