// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/formats/mesh_export.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

namespace hexaplast {
namespace {

/// Collects the text of a file.
class Text {
 public:
  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string escaped(const std::string& name) {
  std::string text;
  for (const char c : name) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += c;
    }
  }
  return text;
}

void add_reals(Text& text, const std::string& name, int components, std::span<const double> values) {
  text.add("<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", escaped(name),
           components);
  for (std::size_t i = 0; i < values.size(); ++i)
    text.add("{}{}", values[i], (i + 1) % static_cast<std::size_t>(components) == 0 ? '\n' : ' ');
  text.add("</DataArray>\n");
}

template <class Visit>
void for_each_kind(const ExportedMesh& mesh, const Visit& visit) {
  visit(mesh.edges, 3);
  visit(mesh.triangles, 5);
  visit(mesh.quads, 9);
  visit(mesh.hexahedra, 12);
}

void add_cells(Text& text, const ExportedMesh& mesh) {
  text.add("<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n");
  for_each_kind(mesh, [&](const auto& cells, int) {
    for (const auto& cell : cells) text.add("{}\n", fmt::join(cell, " "));
  });
  text.add("</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n");
  std::size_t end = 0;
  for_each_kind(mesh, [&](const auto& cells, int) {
    for (const auto& cell : cells) text.add("{}\n", end += cell.size());
  });
  text.add("</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n");
  for_each_kind(mesh, [&](const auto& cells, int kind) {
    for (std::size_t i = 0; i < cells.size(); ++i) text.add("{}\n", kind);
  });
  text.add("</DataArray>\n</Cells>\n");
}

void add_fields(Text& text, const char* element, const std::vector<ExportedField>& fields) {
  if (fields.empty()) return;
  text.add("<{}>\n", element);
  for (const ExportedField& field : fields) add_reals(text, field.name, field.components, field.values);
  text.add("</{}>\n", element);
}

/// As many digits as fit into what CalculiX reads of a number.
std::string short_number(double value) {
  constexpr std::size_t kLongest = 20;
  std::string text = fmt::format("{}", value);
  for (int digits = 16; text.size() > kLongest; --digits) text = fmt::format("{:.{}g}", value, digits);
  return text;
}

std::string joined_from_1(std::span<const int> nodes, const char* separator) {
  std::string text;
  for (const int node : nodes) text += fmt::format("{}{}", text.empty() ? "" : separator, node + 1);
  return text;
}

}  // namespace

std::string vtu_text(const ExportedMesh& mesh) {
  std::size_t num_cells = 0;
  for_each_kind(mesh, [&](const auto& cells, int) { num_cells += cells.size(); });

  Text text;
  text.add(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n");
  text.add("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", mesh.points.size() / 3,
           num_cells);
  text.add("<Points>\n");
  add_reals(text, "Points", 3, mesh.points);
  text.add("</Points>\n");
  add_cells(text, mesh);
  add_fields(text, "PointData", mesh.point_fields);
  add_fields(text, "CellData", mesh.cell_fields);
  text.add("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
  return text.take();
}

std::string gmsh_text(const ExportedMesh& mesh) {
  Text text;
  text.add("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", mesh.points.size() / 3);
  for (std::size_t n = 0; n < mesh.points.size() / 3; ++n)
    text.add("{} {} {} {}\n", n + 1, mesh.points[3 * n], mesh.points[3 * n + 1], mesh.points[3 * n + 2]);

  std::size_t num_cells = 0;
  for_each_kind(mesh, [&](const auto& cells, int) { num_cells += cells.size(); });
  text.add("$EndNodes\n$Elements\n{}\n", num_cells);
  std::size_t number = 0;
  for_each_kind(mesh, [&](const auto& cells, int kind) {
    const int type = kind == 3 ? 1 : kind == 5 ? 2 : kind == 9 ? 3 : 5;
    // two tags, as Gmsh demands: physical and elementary entity, one of each for a kind of cell
    for (const auto& cell : cells) text.add("{} {} 2 {} {} {}\n", ++number, type, type, type, joined_from_1(cell, " "));
  });
  text.add("$EndElements\n");
  return text.take();
}

std::string abaqus_text(const ExportedMesh& mesh) {
  Text text;
  text.add("*NODE, NSET=ALL\n");
  for (std::size_t n = 0; n < mesh.points.size() / 3; ++n)
    text.add("{}, {}, {}, {}\n", n + 1, short_number(mesh.points[3 * n]), short_number(mesh.points[3 * n + 1]),
             short_number(mesh.points[3 * n + 2]));
  std::size_t number = 0;
  for_each_kind(mesh, [&](const auto& cells, int kind) {
    if (cells.empty()) return;
    const auto [type, set] = kind == 3   ? std::pair("T3D2", "EDGES")
                             : kind == 5 ? std::pair("S3", "TRIANGLES")
                             : kind == 9 ? std::pair("S4", "QUADS")
                                         : std::pair("C3D8", "BODY");
    text.add("*ELEMENT, TYPE={}, ELSET={}\n", type, set);
    for (const auto& cell : cells) text.add("{}, {}\n", ++number, joined_from_1(cell, ", "));
  });
  return text.take();
}

}  // namespace hexaplast
