// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>

#include "formats/vtu_grid.hpp"
#include "hexaplast/formats/mesh_export.hpp"

namespace hexaplast {

/// visit(cells, kind): the cells of a mesh, one kind of VTK's after the other, in the order in which they are written.
template <class Visit>
void for_each_kind(const ExportedMesh& mesh, const Visit& visit) {
  visit(mesh.edges, kVtkLine);
  visit(mesh.triangles, kVtkTriangle);
  visit(mesh.quads, kVtkQuad);
  visit(mesh.hexahedra, kVtkHexahedron);
}

/// Nodes of a cell, counted from 1.
inline std::string joined_from_1(std::span<const int> nodes, const char* separator) {
  std::string text;
  for (const int node : nodes) text += fmt::format("{}{}", text.empty() ? "" : separator, node + 1);
  return text;
}

}  // namespace hexaplast
