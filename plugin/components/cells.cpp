// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/body.hpp"
#include "hexaplast/mesh/node_copies.hpp"

namespace hexaplast::components {

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
