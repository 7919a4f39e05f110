// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/formats/mesh_import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "mesh_source.hpp"

namespace hexaplast {
namespace {

/// A function that adds a cell which is not there yet, whatever the order of its nodes.
template <class Cell>
auto without_twins(std::vector<Cell>& cells) {
  std::set<Cell> known;
  for (const Cell& cell : cells) known.insert(sorted(cell));
  return [&cells, known = std::move(known)](const Cell& cell) mutable {
    if (known.insert(sorted(cell)).second) cells.push_back(cell);
  };
}

}  // namespace

std::vector<std::string> what_is_left_out(const ImportedMesh& mesh) {
  std::vector<std::string> sentences;
  int num_skipped = 0;
  std::string kinds;
  for (const auto& [kind, count] : mesh.skipped) {
    num_skipped += count;
    kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", count, kind);
  }
  if (num_skipped > 0)
    sentences.push_back(fmt::format(
        "{} cells are skipped: neither edges, triangles, quads nor hexahedra of first order: {}", num_skipped, kinds));
  if (mesh.num_copies > 0)
    sentences.push_back(fmt::format("{} cells stand there again, and are taken once", mesh.num_copies));
  if (mesh.num_degenerate > 0)
    sentences.push_back(
        fmt::format("{} triangles are left out: two of their corners are in one place", mesh.num_degenerate));
  return sentences;
}

MeshFormat format_of(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".msh") return MeshFormat::kGmsh;
  if (ending == ".vtk" || ending == ".vtu") return MeshFormat::kVtk;
  if (ending == ".obj") return MeshFormat::kObj;
  if (ending == ".stl") return MeshFormat::kStl;
  throw InputError(fmt::format("{}: a mesh file's name must end in .msh, .vtk, .vtu, .obj or .stl", file.string()));
}

ImportedMesh read_mesh(const std::filesystem::path& file) { return read_mesh(file, format_of(file)); }

ImportedMesh read_mesh(const std::filesystem::path& file, MeshFormat format) {
  return parse_mesh(whole_file(file), file.string(), format);
}

ImportedMesh parse_mesh(std::string_view content, const std::string& name, MeshFormat format) {
  constexpr std::array kParsers = {parse_gmsh, parse_vtk, parse_obj, parse_stl};
  return kParsers[static_cast<std::size_t>(format)](content, name);
}

QuadSurface surface_of(const ImportedMesh& mesh) {
  if (!mesh.triangles.empty()) {
    const Triangle& first = mesh.triangles.front();
    throw InputError(
        fmt::format("{} triangles, or parts of polygons, among {} quads, the first one with the vertices {} (counted "
                    "from 0); all faces must be quads",
                    mesh.triangles.size(), mesh.quads.size(), fmt::join(first, ", ")));
  }
  return QuadSurface(mesh.positions, mesh.quads);
}

void triangulate(ImportedMesh& mesh) {
  for (const Quad& quad : mesh.quads) {
    mesh.triangles.push_back({quad[0], quad[1], quad[2]});
    mesh.triangles.push_back({quad[0], quad[2], quad[3]});
  }
  mesh.quads.clear();
}

void add_boundaries_of_cells(ImportedMesh& mesh) {
  auto add_quad = without_twins(mesh.quads);
  for (const Hexahedron& hexahedron : mesh.hexahedra)
    for (const Quad& face : kFaces) add_quad(face_of(hexahedron, face));

  auto add_edges = [add_edge = without_twins(mesh.edges)](const auto& faces) mutable {
    for (const auto& face : faces)
      for (std::size_t n = face.size(), k = 0; k < n; ++k) add_edge({face[(k + 1) % n], face[(k + 2) % n]});
  };
  add_edges(mesh.quads);
  add_edges(mesh.triangles);
}

void remove_unused_nodes(ImportedMesh& mesh) {
  const auto for_each_list = [&](const auto& visit) {
    visit(mesh.edges);
    visit(mesh.triangles);
    visit(mesh.quads);
    visit(mesh.hexahedra);
  };
  std::vector<int> number(static_cast<std::size_t>(mesh.positions.rows()), -1);
  for_each_list([&](const auto& cells) {
    for (const auto& cell : cells)
      for (const int node : cell) number[node] = 0;
  });

  int next = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    mesh.positions.row(next) = mesh.positions.row(static_cast<Eigen::Index>(n)).eval();
    number[n] = next++;
  }
  mesh.positions.conservativeResize(next, 3);
  for_each_list([&](auto& cells) {
    for (auto& cell : cells)
      for (int& node : cell) node = number[node];
  });
}

}  // namespace hexaplast
