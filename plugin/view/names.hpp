// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace hexaplast::view {

/// What the hexahedra of a mesh belong to.
struct Names {
  struct Body {
    std::string name;
    int first_hexahedron = 0;
  };
  std::vector<Body> bodies = {};  ///< in the order of the mesh; empty: unknown
  std::vector<int> regions = {};  ///< of each hexahedron from 1, 0: none; empty: there are none
  std::vector<std::string> region_names = {};

  /// "liver, tumour, hexahedron 12", with the number that the hexahedron has in its body.
  std::string of(int hexahedron) const;
};

}  // namespace hexaplast::view
