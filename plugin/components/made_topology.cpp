// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/made_topology.hpp"

#include "components/cells.hpp"
#include "hexaplast/mesh/faces.hpp"

namespace hexaplast::components {

const std::vector<Quad>& MadeTopology::quads() {
  if (!quads_) quads_ = make_quads();
  return *quads_;
}

const std::vector<Edge>& MadeTopology::edges() {
  if (!edges_) edges_ = make_edges();
  return *edges_;
}

std::vector<Quad> MadeTopology::make_quads() { return faces_of(hexahedra()); }
std::vector<Edge> MadeTopology::make_edges() { return edges_of(hexahedra()); }

void MadeTopology::provide(scene::Data& output) {
  const std::string_view name = output.attribute().name;
  if (name == "position") output.set_once([this] { return flattened(positions()); });
  if (name == "hexahedra") output.set_once([this] { return flattened<8>(hexahedra()); });
  if (name == "quads") output.set_once([this] { return flattened<4>(quads()); });
  if (name == "edges") output.set_once([this] { return flattened<2>(edges()); });
}

}  // namespace hexaplast::components
