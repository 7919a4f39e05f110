// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::runner {

/// The lines of `mesh info` that speak of hexahedra.
void print_hexahedra(const HexMesh& mesh);

}  // namespace hexaplast::runner
