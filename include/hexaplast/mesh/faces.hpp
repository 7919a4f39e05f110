// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/base/hexahedron.hpp"

namespace hexaplast {

/// The faces of all hexahedra, each once: in the order of the hexahedra and of kFaces, seen from outside the first
/// hexahedron that has it, beginning with its least node. These are the quads that SOFA gives a mesh of hexahedra.
std::vector<Quad> faces_of(std::span<const Hexahedron> hexahedra);

/// The edges of all hexahedra, each once, lesser node first: in the order of the hexahedra and of kEdges.
std::vector<Edge> edges_of(std::span<const Hexahedron> hexahedra);

}  // namespace hexaplast
