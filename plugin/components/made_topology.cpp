// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/made_topology.hpp"

#include <fmt/format.h>

#include "components/cells.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/memory.hpp"

namespace hexaplast::components {
namespace {

constexpr double kMostCells = 16'777'216;

}  // namespace

void MadeTopology::provide(scene::Data& output) {
  const std::string_view name = output.attribute().name;
  if (name == "position") output.set_once([this] { return flattened(positions()); });
  if (name == "hexahedra") output.set_once([this] { return flattened<8>(hexahedra()); });
  if (name == "quads") output.set_once([this] { return flattened<4>(quads()); });
  if (name == "edges") output.set_once([this] { return flattened<2>(edges()); });
}

void MadeTopology::require_few(std::string_view attribute, double num_cells) {
  if (num_cells > kMostCells)
    reject(attribute, fmt::format("{:.4g} cells, must be at most {:.10g}", num_cells, kMostCells));
}

void MadeTopology::require_feasible(std::string_view attribute, double num_hexahedra) {
  require_few(attribute, num_hexahedra);
  try {
    require_memory(num_hexahedra);
  } catch (const InputError& error) {
    reject(attribute, error.what());
  }
}

}  // namespace hexaplast::components
