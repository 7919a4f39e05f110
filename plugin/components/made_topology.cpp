// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/made_topology.hpp"

#include "components/cells.hpp"

namespace hexaplast::components {

void MadeTopology::provide(scene::Data& output) {
  const std::string_view name = output.attribute().name;
  if (name == "position") output.set_once([this] { return flattened(positions()); });
  if (name == "hexahedra") output.set_once([this] { return flattened<8>(hexahedra()); });
  if (name == "quads") output.set_once([this] { return flattened<4>(quads()); });
  if (name == "edges") output.set_once([this] { return flattened<2>(edges()); });
}

}  // namespace hexaplast::components
