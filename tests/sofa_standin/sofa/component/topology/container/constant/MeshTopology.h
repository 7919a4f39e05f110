// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/core/topology/BaseMeshTopology.h>

namespace sofa::component::topology::container::constant {

class MeshTopology : public core::topology::BaseMeshTopology {
 public:
  SOFA_CLASS(MeshTopology, core::topology::BaseMeshTopology);

  const SeqHexahedra& getHexahedra() override { return d_seqHexahedra.getValue(); }

  core::objectmodel::Data<type::vector<type::Vec3>> d_seqPoints{initData(&d_seqPoints, "position", "Nodes.")};
  core::objectmodel::Data<SeqHexahedra> d_seqHexahedra{initData(&d_seqHexahedra, "hexahedra", "Hexahedra.")};
  core::objectmodel::Data<type::vector<Index>> d_seqQuads{initData(&d_seqQuads, "quads", "Quads.")};
  core::objectmodel::Data<type::vector<Index>> d_seqEdges{initData(&d_seqEdges, "edges", "Edges.")};
};

}  // namespace sofa::component::topology::container::constant
