// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>

#include "components/made_topology.hpp"

namespace hexaplast::components {

/// Cells of a grid, as many as n or cellWidth says.
class GridTopology : public MadeTopology {
 public:
  using MadeTopology::MadeTopology;

 protected:
  /// In each direction, as reals: their product may be too large for any whole number.
  Vec3 num_cells(const Vec3& size) {
    const double width = real("cellWidth");
    if (width > 0) return (size / width).array().ceil();
    const std::vector<std::int64_t>& n = integers("n");
    if (n.size() != 3) reject("n", fmt::format("{} numbers given, must be three", n.size()));
    return Vec3(static_cast<double>(n[0] - 1), static_cast<double>(n[1] - 1), static_cast<double>(n[2] - 1));
  }
};

}  // namespace hexaplast::components
