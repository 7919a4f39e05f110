// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/body.hpp"
#include "hexaplast/mesh/node_copies.hpp"

namespace hexaplast::components {

template <std::size_t N>
std::vector<std::array<int, N>> cells_of(scene::Object& owner, std::string_view attribute, int num_nodes) {
  const std::vector<int> nodes = owner.indices(attribute, num_nodes);
  if (nodes.size() % N != 0)
    owner.reject(attribute, fmt::format("{} numbers given, must be groups of {}", nodes.size(), N));
  std::vector<std::array<int, N>> cells(nodes.size() / N);
  for (std::size_t i = 0; i < nodes.size(); ++i) cells[i / N][i % N] = nodes[i];
  return cells;
}
template std::vector<Edge> cells_of<2>(scene::Object&, std::string_view, int);
template std::vector<Triangle> cells_of<3>(scene::Object&, std::string_view, int);
template std::vector<Quad> cells_of<4>(scene::Object&, std::string_view, int);
template std::vector<Hexahedron> cells_of<8>(scene::Object&, std::string_view, int);

template <std::size_t N>
std::vector<std::int64_t> flattened(std::span<const std::array<int, N>> cells) {
  std::vector<std::int64_t> nodes;
  nodes.reserve(N * cells.size());
  for (const auto& cell : cells) nodes.insert(nodes.end(), cell.begin(), cell.end());
  return nodes;
}
template std::vector<std::int64_t> flattened<2>(std::span<const Edge>);
template std::vector<std::int64_t> flattened<3>(std::span<const Triangle>);
template std::vector<std::int64_t> flattened<4>(std::span<const Quad>);
template std::vector<std::int64_t> flattened<8>(std::span<const Hexahedron>);

template <std::size_t N>
std::vector<std::int64_t> flattened(std::span<const std::array<int, N>> cells, std::span<const int> chosen) {
  std::vector<std::int64_t> nodes;
  nodes.reserve(N * chosen.size());
  for (const int e : chosen) nodes.insert(nodes.end(), cells[e].begin(), cells[e].end());
  return nodes;
}
template std::vector<std::int64_t> flattened<2>(std::span<const Edge>, std::span<const int>);
template std::vector<std::int64_t> flattened<3>(std::span<const Triangle>, std::span<const int>);
template std::vector<std::int64_t> flattened<4>(std::span<const Quad>, std::span<const int>);
template std::vector<std::int64_t> flattened<8>(std::span<const Hexahedron>, std::span<const int>);

const std::vector<Hexahedron>& present_hexahedra(const std::vector<Hexahedron>& of_topology,
                                                 const scene::MechanicalState& state) {
  return state.split_by() ? state.split_by()->mesh().hexahedra() : of_topology;
}

std::string are_others(const std::vector<Hexahedron>& of_topology, const Body& body) {
  const std::vector<int>& initial = body.copies().initial();
  const bool are_same =
      std::ranges::equal(of_topology, body.mesh().hexahedra(), [&](const Hexahedron& own, const Hexahedron& present) {
        return std::ranges::equal(own, present, {}, {}, [&](int node) { return initial[node]; });
      });
  return are_same ? "" : "has other hexahedra than the body";
}

void require_same_nodes(scene::Component& component, scene::Topology& topology, int num_nodes) {
  const Eigen::Index count = topology.positions().rows();
  if (count != 0 && count != num_nodes)
    component.reject(fmt::format("{} nodes in the topology, {} in the mechanical state", count, num_nodes));
}

const std::vector<Hexahedron>& hexahedra_on(scene::Component& component, scene::Topology& topology, int num_nodes) {
  require_same_nodes(component, topology, num_nodes);
  const std::vector<Hexahedron>& hexahedra = topology.hexahedra();
  if (hexahedra.empty()) component.reject("its topology has no hexahedra");
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    const int greatest = std::ranges::max(hexahedra[e]);
    if (greatest >= num_nodes)
      component.reject(fmt::format("hexahedron {} of its topology has node {}, the mechanical state has {} nodes", e,
                                   greatest, num_nodes));
  }
  return hexahedra;
}

}  // namespace hexaplast::components
