// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/objectmodel/BaseComponent.h>
#include <sofa/core/topology/TopologyChange.h>

#include <list>

namespace sofa::core::topology {

class Topology : public objectmodel::BaseComponent {
 public:
  using Hexa = type::Vec<8, Index>;
  using SeqHexahedra = type::vector<Hexa>;
  using Triangle = type::Vec<3, Index>;
  using SeqTriangles = type::vector<Triangle>;
};

class BaseMeshTopology : public Topology {
 public:
  virtual const SeqHexahedra& getHexahedra() = 0;
  Size getNbHexahedra() { return static_cast<Size>(getHexahedra().size()); }

  std::list<const TopologyChange*>::const_iterator beginChange() const { return changes.begin(); }
  std::list<const TopologyChange*>::const_iterator endChange() const { return changes.end(); }

  std::list<const TopologyChange*> changes;
};

}  // namespace sofa::core::topology

inline sofa::core::topology::BaseMeshTopology* sofa::core::objectmodel::BaseContext::getMeshTopologyLink() const {
  return get<topology::BaseMeshTopology>();
}
