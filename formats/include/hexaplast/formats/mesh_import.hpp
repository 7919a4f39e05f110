// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/base/types.hpp"
#include "hexaplast/geometry/quad_surface.hpp"

namespace hexaplast {

/// Hexahedra that a file puts together.
struct ImportedGroup {
  std::string name;            ///< or its number, where it has no name
  std::vector<int> hexahedra;  ///< their numbers in the mesh
};

/// What is taken from a mesh file: nodes in the order of the file, and linear cells by node, in the corner order of
/// base/types.hpp. Every corner is a row of `positions`. The geometry is not judged: that is HexMesh's part. A cell
/// that stands in the file again, with the same nodes in the same order, is taken once: Gmsh writes it for each of its
/// groups.
struct ImportedMesh {
  PointArray positions;  ///< [m] num_nodes x 3
  std::vector<Edge> edges;
  std::vector<Triangle> triangles;
  std::vector<Quad> quads;
  std::vector<Hexahedron> hexahedra;
  std::vector<ImportedGroup> groups = {};   ///< of Gmsh: the physical groups of volumes
  std::map<std::string, int> skipped = {};  ///< how many cells of other kinds, by what they are
  int num_copies = 0;                       ///< cells that stand there again
  bool is_of_patient = false;  ///< x, y and z run to the left, the back and the head (LPS), as `mesh voxels` writes
  int num_degenerate = 0;      ///< triangles of .stl files that are left out, as two of their corners are in one place
};

/// Numbers that a file holds per point or per cell, or of the whole.
struct ImportedArray {
  std::string name;
  int num_components = 1;
  std::vector<double> values;  ///< all components of the first point or cell, then those of the second one, ...
};

/// A mesh with what its file says about points, and about cells in the order of the file.
struct ImportedState {
  ImportedMesh mesh;
  std::vector<ImportedArray> point_data, cell_data;
  std::vector<int> hexahedron_cells =
      {};  ///< which cell of the file each hexahedron of the mesh is; of copies the first
  std::vector<std::string> field_names = {};   ///< of the arrays of the grid as a whole
  std::vector<ImportedArray> field_data = {};  ///< of these, those that say how many numbers they hold
};

/// What of the file is not in the mesh and why, a sentence each: skipped cells, copies, triangles left out.
std::vector<std::string> what_is_left_out(const ImportedMesh& mesh);

/// kGmsh: versions 2 and 4.1, text or binary of either byte order.
///
/// kVtk: unstructured grids: legacy files (text or big-endian binary, versions up to 5.1) and XML files (.vtu: text,
/// base64, or raw appended data; uncompressed or by zlib). Which of the two it is is told by the content.
///
/// kObj: vertices, polylines, and faces; those of more than four corners are cut into triangles around their first
/// corner.
///
/// kStl: text or binary (little-endian): triangles. Corners in exactly the same place become one node, in the order of
/// their first appearance. A file is binary if its size is that of the triangles that it counts, whatever its first
/// word. Normals are not read.
enum class MeshFormat { kGmsh, kVtk, kObj, kStl };

/// Whichever the ending of a file's name stands for: .msh, .vtk, .vtu, .obj or .stl.
MeshFormat format_of(const std::filesystem::path& file);

ImportedMesh read_mesh(const std::filesystem::path& file);
ImportedMesh read_mesh(const std::filesystem::path& file, MeshFormat format);

/// A .vtu file of one piece with its data; arrays of text are passed over.
ImportedState read_vtu_state(const std::filesystem::path& file);

/// All of these throw InputError: "FILE:LINE: what" where the file is text, "FILE: byte N: what" in binary data, for
/// files that are missing, not regular, truncated or inconsistent. Nothing is allocated by a number in a file before
/// that number has been compared with the file's size.
///
/// The same from content in memory; `name` stands for the file in messages.
ImportedMesh parse_mesh(std::string_view content, const std::string& name, MeshFormat format);
ImportedState parse_vtu_state(std::string_view content, const std::string& name);

/// The faces as a surface. Throws InputError as QuadSurface does, and where a face is not a quad.
QuadSurface surface_of(const ImportedMesh& mesh);

/// Cuts every quad into two triangles, (0, 1, 2) and (0, 2, 3).
void triangulate(ImportedMesh& mesh);

/// Adds the faces of hexahedra and then the edges of quads and triangles that are not among the quads and edges yet.
void add_boundaries_of_cells(ImportedMesh& mesh);

/// Removes nodes that no cell has; the others keep their order.
void remove_unused_nodes(ImportedMesh& mesh);

}  // namespace hexaplast
