// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast {

/// The faces of all hexahedra, each once: in the order of the hexahedra and of kFaces, seen from outside the first
/// hexahedron that has it, beginning with its smallest node. These are the quads that SOFA gives a mesh of hexahedra.
std::vector<Quad> faces_of(std::span<const Hexahedron> hexahedra);

/// The edges of all hexahedra, each once, lesser node first: in the order of the hexahedra and of kEdges.
std::vector<Edge> edges_of(std::span<const Hexahedron> hexahedra);

/// Per node, the mean of one value per hexahedron over those that have the node; 0 where none has it.
/// alive: if not empty, one per hexahedron, 0 for those that do not count.
std::vector<double> nodal_means(const HexMesh& mesh, std::span<const double> of_hexahedra,
                                std::span<const unsigned char> alive = {});

/// Whether nodes still belong together in a mesh of which some elements are gone: false when elements had all of these
/// nodes as corners, and each of them is gone. For the nodes of an edge or a face, or for a single one: whether it is
/// part of what is left. Nodes that no element ever had together belong together as before.
/// nodes: at least one, in [0, num_nodes); alive: one entry per element, 0 for those that are gone.
bool hold_together(const HexMesh& mesh, std::span<const unsigned char> alive, std::span<const int> nodes);

}  // namespace hexaplast
