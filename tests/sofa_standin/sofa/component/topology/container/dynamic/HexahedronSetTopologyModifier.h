// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/component/topology/container/constant/MeshTopology.h>

#include <algorithm>
#include <functional>

namespace sofa::component::topology::container::dynamic {

/// Takes hexahedra out of the MeshTopology of its node, whose place SOFA's own has a container for. Like SOFA's it
/// tells everybody first, then fills each gap with the last hexahedron, greatest number first.
class HexahedronSetTopologyModifier : public core::objectmodel::BaseComponent {
 public:
  SOFA_CLASS(HexahedronSetTopologyModifier, core::objectmodel::BaseComponent);

  core::objectmodel::Data<bool> removeIsolated{
      initData(&removeIsolated, true, "removeIsolated", "Takes nodes without hexahedra away.")};

  void removeHexahedra(const type::vector<Index>& hexahedra) {
    auto* topology = getContext()->get<constant::MeshTopology>(core::objectmodel::BaseContext::Local);
    type::vector<Index> gone = hexahedra;
    std::sort(gone.begin(), gone.end(), std::greater<>());
    announce(*topology, core::topology::HexahedraRemoved(gone));

    auto& left = *topology->d_seqHexahedra.beginEdit();
    for (const Index i : gone) {
      left[i] = left.back();
      left.pop_back();
    }
    if (removeIsolated.getValue()) announce(*topology, core::topology::TopologyChange(core::topology::POINTSREMOVED));
  }

  /// Tells every component at and below its node.
  void announce(constant::MeshTopology& topology, const core::topology::TopologyChange& change) {
    topology.changes.push_back(&change);
    getContext()->for_each([&](core::objectmodel::BaseComponent& each) { each.handleTopologyChange(&topology); });
    topology.changes.clear();
  }
};

}  // namespace sofa::component::topology::container::dynamic
