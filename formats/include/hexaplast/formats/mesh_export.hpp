// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A number for each cell of a mesh.
struct ExportedField {
  std::string name;
  std::span<const double> values;
};

/// What is written: all spans must outlive it. Cells stand in the file in the order of the members.
struct ExportedMesh {
  std::span<const double> points;  ///< [m] three per point
  std::span<const Edge> edges = {};
  std::span<const Triangle> triangles = {};
  std::span<const Quad> quads = {};
  std::span<const Hexahedron> hexahedra = {};
  std::vector<ExportedField> cell_fields = {};
};

/// The mesh as a VTK unstructured grid (.vtu), as text, every number with as many digits as it takes to read it back.
/// Names of fields are escaped where XML demands it.
std::string vtu_text(const ExportedMesh& mesh);

/// The points, edges and faces as Wavefront OBJ, without hexahedra and fields.
std::string obj_text(const ExportedMesh& mesh);

}  // namespace hexaplast
