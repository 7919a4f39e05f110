// SPDX-License-Identifier: LGPL-2.1-or-later
// Part of a stand-in for SOFA: knows just what the adapter calls, for tests without SOFA. See README.md there.
#pragma once

#include <sofa/component/topology/container/constant/MeshTopology.h>

namespace sofa::component::topology::container::grid {

/// Has the cells that a test gives it.
class SparseGridTopology : public constant::MeshTopology {
 public:
  SOFA_CLASS(SparseGridTopology, constant::MeshTopology);

  virtual float getStiffnessCoef(Index hexahedron) { return fill.at(hexahedron); }

  std::vector<float> fill;  // fraction of each hexahedron that is full
};

}  // namespace sofa::component::topology::container::grid
