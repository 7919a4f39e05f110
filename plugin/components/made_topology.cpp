// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/made_topology.hpp"

#include "components/cells.hpp"

namespace hexaplast::components {

void MadeTopology::provide(scene::Data& output) {
  const std::string_view name = output.attribute().name;
  if (name == "position") {
    const PointArray& x = positions();
    output.set(std::vector<double>(x.data(), x.data() + x.size()));
  }
  if (name == "hexahedra") output.set(flattened<8>(hexahedra()));
  if (name == "quads") output.set(flattened<4>(quads()));
  if (name == "edges") output.set(flattened<2>(edges()));
}

}  // namespace hexaplast::components
