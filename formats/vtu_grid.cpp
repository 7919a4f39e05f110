// SPDX-License-Identifier: LGPL-2.1-or-later
#include "formats/vtu_grid.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <limits>

#include "formats/xml.hpp"
#include "hexaplast/formats/mesh_export.hpp"
#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say LittleEndian and hold memory as it is");

/// Data of the whole, points, topology, data of points and of cells.
using Groups = std::array<std::vector<VtuArray>, 5>;

Groups groups_of(const VtuGrid& grid) {
  return {{grid.field_arrays,
           {reals("Points", 3, grid.points)},
           {{"Int32", "connectivity", 1, grid.connectivity},
            scalars("Int64", "offsets", grid.ends),
            scalars("UInt8", "types", grid.types)},
           grid.point_data,
           grid.cell_data}};
}

std::size_t num_tuples(const VtuArray& array) {
  const std::size_t size = array.type.ends_with("64") ? 8 : array.type.ends_with("32") ? 4 : 1;  // of a number
  return array.bytes.size() / (size * static_cast<std::size_t>(array.components));
}

/// The elements of a file up to the end of its grid. describe(array) is the element of an array.
template <class Describe>
std::string xml_of(const VtuGrid& grid, const Groups& groups, const Describe& describe) {
  const auto all = [&](const std::vector<VtuArray>& arrays) {
    std::string text;
    for (const VtuArray& array : arrays) {
      const std::string shape = array.components > 1 ? fmt::format(" NumberOfComponents=\"{}\"", array.components) : "";
      const std::string count =
          &arrays == groups.data() ? fmt::format(" NumberOfTuples=\"{}\"", num_tuples(array)) : "";
      text += fmt::format("        <DataArray type=\"{}\" Name=\"{}\"{}{} {}\n", array.type, escaped(array.name), shape,
                          count, describe(array));
    }
    return text;
  };
  std::string xml =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n";
  if (!grid.field_data.empty() || !grid.field_arrays.empty()) {
    xml += "    <FieldData>\n";
    for (const VtuNumber& number : grid.field_data)
      xml += fmt::format(
          "      <DataArray type=\"Int32\" Name=\"{}\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n",
          escaped(number.name), number.value);
    xml += all(groups[0]) + "    </FieldData>\n";
  }
  xml +=
      fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", grid.points.size() / 3, grid.ends.size());
  xml += "      <Points>\n" + all(groups[1]) + "      </Points>\n";
  xml += "      <Cells>\n" + all(groups[2]) + "      </Cells>\n";
  xml += "      <PointData>\n" + all(groups[3]) + "      </PointData>\n";
  xml += grid.shown_first.empty() ? "      <CellData>\n"
                                  : fmt::format("      <CellData Scalars=\"{}\">\n", escaped(grid.shown_first));
  xml += all(groups[4]) + "      </CellData>\n";
  return xml + "    </Piece>\n  </UnstructuredGrid>\n";
}

// The connectivity is on one line, with one blank between two numbers: SOFA's MeshVTKLoader counts its blanks.
template <class Number>
std::string numbers_in_text(const VtuArray& array) {
  constexpr int kScalarsPerLine = 8;
  const std::size_t count = array.bytes.size() / sizeof(Number);
  const auto per_line = array.name == "connectivity"
                            ? count
                            : static_cast<std::size_t>(array.components > 1 ? array.components : kScalarsPerLine);
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    Number number;
    std::memcpy(&number, array.bytes.data() + i * sizeof number, sizeof number);
    fmt::format_to(std::back_inserter(text), "{}{}", number, (i + 1) % per_line == 0 || i + 1 == count ? '\n' : ' ');
  }
  return text;
}

std::string text_of(const VtuArray& array) {
  if (array.type == "Float64") return numbers_in_text<double>(array);
  if (array.type == "Int64") return numbers_in_text<std::int64_t>(array);
  if (array.type == "Int32") return numbers_in_text<std::int32_t>(array);
  return numbers_in_text<std::uint8_t>(array);
}

}  // namespace

VtuArray reals(std::string_view name, int components, std::span<const double> values) {
  return {"Float64", name, components, std::as_bytes(values)};
}

VtuArray vectors(std::string_view name, const PointArray& field) {
  return reals(name, 3, {field.data(), static_cast<std::size_t>(field.size())});
}

void VtuGrid::add_cells(std::size_t count, std::uint8_t type, int corners) {
  std::int64_t end = ends.empty() ? 0 : ends.back();
  for (std::size_t cell = 0; cell < count; ++cell) ends.push_back(end += corners);
  types.insert(types.end(), count, type);
}

void VtuGrid::write(const std::filesystem::path& file) const {
  const Groups groups = groups_of(*this);
  // Appended blocks are 8 bytes of length, then the data. They lie backwards, the last array first: meshio looks arrays
  // up by their offsets while it replaces these one by one in the order of the blocks, and would take one array for
  // another where an old offset and a new one are equal.
  const auto block_size = [](const VtuArray& array) { return sizeof(std::uint64_t) + array.bytes.size(); };
  std::uint64_t rest = 0;  // size of the blocks of arrays that have not been described
  for (const std::vector<VtuArray>& group : groups)
    for (const VtuArray& array : group) rest += block_size(array);
  WholeFile out(file);
  out.write(xml_of(*this, groups, [&](const VtuArray& array) {
    return fmt::format("format=\"appended\" offset=\"{}\"/>", rest -= block_size(array));
  }));
  out.write("  <AppendedData encoding=\"raw\">\n_");
  for (auto group = groups.rbegin(); group != groups.rend(); ++group)
    for (auto array = group->rbegin(); array != group->rend(); ++array) {
      const std::uint64_t bytes = array->bytes.size();
      out.write(&bytes, sizeof bytes);
      out.write(array->bytes.data(), array->bytes.size());
    }
  out.write("\n  </AppendedData>\n</VTKFile>\n");
  out.commit();
}

std::string VtuGrid::text() const {
  Groups groups = groups_of(*this);
  std::vector<std::int32_t> short_ends;  // all that SOFA's MeshVTKLoader reads
  if (ends.empty() || ends.back() <= std::numeric_limits<std::int32_t>::max()) {
    short_ends.assign(ends.begin(), ends.end());
    groups[2][1] = scalars("Int32", "offsets", short_ends);
  }
  // no blanks before the end of an array: see above
  return xml_of(
             *this, groups,
             [](const VtuArray& array) { return fmt::format("format=\"ascii\">\n{}</DataArray>", text_of(array)); }) +
         "</VTKFile>\n";
}

std::string vtu_text(const ExportedMesh& mesh) {
  VtuGrid grid{.points = mesh.points};
  std::vector<std::int32_t> connectivity;
  const auto add = [&]<std::size_t N>(std::span<const std::array<int, N>> cells, std::uint8_t kind) {
    grid.add_cells(cells.size(), kind, N);
    for (const auto& cell : cells) connectivity.insert(connectivity.end(), cell.begin(), cell.end());
  };
  add(mesh.edges, kVtkLine);
  add(mesh.triangles, kVtkTriangle);
  add(mesh.quads, kVtkQuad);
  add(mesh.hexahedra, kVtkHexahedron);
  grid.connectivity = std::as_bytes(std::span(connectivity));
  for (const ExportedField& field : mesh.cell_fields) grid.cell_data.push_back(reals(field.name, 1, field.values));
  return grid.text();
}

}  // namespace hexaplast
