// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>

#include "hexaplast/mesh/hex_mesh.hpp"

namespace hexaplast::support {

/// The numbers of a field as an attribute has them, to the last bit.
inline std::string numbers(const PointArray& field) {
  return fmt::format("{}", fmt::join(field.data(), field.data() + field.size(), " "));
}

/// The topology that has this mesh.
inline std::string mesh_topology(const HexMesh& mesh) {
  std::string hexahedra;
  for (const Hexahedron& corners : mesh.hexahedra()) hexahedra += fmt::format("{}  ", fmt::join(corners, " "));
  return "<MeshTopology name='mesh' position='" + numbers(mesh.positions()) + "' hexahedra='" + hexahedra + "'/>";
}

}  // namespace hexaplast::support
