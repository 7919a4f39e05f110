// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/lattice.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

void NodeLattice::check(int least) const {
  std::int64_t count = 1;
  for (int d = 0; d < 3; ++d) {
    const int min = is_closed_around && d == 1 ? 3 : least;
    if (cells[d] < min)
      throw InputError(fmt::format("a grid of {} cells in direction {}: at least {} needed", cells[d], d, min));
    // checked in each factor, so that the product of the three cannot overflow 64 bits
    count *= std::int64_t{cells[d]} + 1;
    if (count > std::numeric_limits<int>::max())
      throw InputError(fmt::format("a grid of {} x {} x {} cells has more nodes than can be counted ({})", cells[0],
                                   cells[1], cells[2], std::numeric_limits<int>::max()));
  }
}

std::vector<Hexahedron> NodeLattice::hexahedra() const {
  std::vector<Hexahedron> found;
  found.reserve(std::size_t(cells[0]) * cells[1] * cells[2]);
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i)
        found.push_back({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k), node(i, j, k + 1),
                         node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)});
  return found;
}

}  // namespace hexaplast
