// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/file_export.hpp"

#include <fmt/format.h>

#include <iterator>

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

}  // namespace hexaplast
