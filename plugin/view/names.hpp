// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "picture/regions.hpp"
#include "record/manifest.hpp"

namespace hexaplast::view {

/// What the hexahedra of a mesh belong to, and what a scene measures.
struct Names {
  struct Body {
    std::string name;
    int first_hexahedron = 0;
  };
  std::vector<Body> bodies = {};  ///< in the order of the mesh; empty: unknown
  output::Regions regions = {};
  std::vector<output::ProbeRecord> probes = {};

  /// "liver, tumour, hexahedron 12", with the number that the hexahedron has in its body.
  std::string of(int hexahedron) const;
};

}  // namespace hexaplast::view
