// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/vtu_grid.hpp"

#include <fmt/format.h>

#include <bit>
#include <iterator>
#include <string>

#include "record/files.hpp"

namespace hexaplast::output {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say LittleEndian and hold memory as it is");

/// Writes the header's elements and hands out the offsets of the appended blocks: 8 bytes of length, then the data. The
/// blocks lie backwards, the last array first: meshio looks arrays up by their offsets while it replaces these one by
/// one in the order of the blocks, and would take one array for another where an old offset and a new one are equal.
class Layout {
 public:
  explicit Layout(std::span<const std::vector<VtuArray>> groups) {
    for (const std::vector<VtuArray>& group : groups)
      for (const VtuArray& array : group) rest_ += block_size(array);
  }

  std::string describe(std::span<const VtuArray> arrays) {
    std::string text;
    for (const VtuArray& array : arrays) {
      rest_ -= block_size(array);
      const std::string shape = array.components > 1 ? fmt::format(" NumberOfComponents=\"{}\"", array.components) : "";
      text += fmt::format("        <DataArray type=\"{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n",
                          array.type, array.name, shape, rest_);
    }
    return text;
  }

 private:
  static std::uint64_t block_size(const VtuArray& array) { return sizeof(std::uint64_t) + array.bytes.size(); }

  std::uint64_t rest_ = 0;  // size of the blocks of arrays that have not been described
};

}  // namespace

VtuArray vectors(std::string_view name, const PointArray& field) {
  return {"Float64", name, 3, std::as_bytes(std::span(field.data(), static_cast<std::size_t>(field.size())))};
}

void VtuGrid::add_cells(std::size_t count, std::uint8_t type, int corners) {
  std::int64_t end = ends.empty() ? 0 : ends.back();
  for (std::size_t cell = 0; cell < count; ++cell) ends.push_back(end += corners);
  types.insert(types.end(), count, type);
}

void VtuGrid::write(const std::filesystem::path& file) const {
  const std::vector<VtuArray> places{vectors("Points", points)};
  const std::vector<VtuArray> topology{
      {"Int32", "connectivity", 1, connectivity}, scalars("Int64", "offsets", ends), scalars("UInt8", "types", types)};
  const std::vector<VtuArray> groups[] = {places, topology, point_data, cell_data};

  Layout layout(groups);
  std::string header =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n";
  header += fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", points.rows(), ends.size());
  header += "      <Points>\n" + layout.describe(places) + "      </Points>\n";
  header += "      <Cells>\n" + layout.describe(topology) + "      </Cells>\n";
  header += "      <PointData>\n" + layout.describe(point_data) + "      </PointData>\n";
  header += shown_first.empty() ? "      <CellData>\n" : fmt::format("      <CellData Scalars=\"{}\">\n", shown_first);
  header += layout.describe(cell_data) + "      </CellData>\n";
  header += "    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";

  WholeFile out(file);
  out.write(header);
  for (auto group = std::rbegin(groups); group != std::rend(groups); ++group)
    for (auto array = group->rbegin(); array != group->rend(); ++array) {
      const std::uint64_t bytes = array->bytes.size();
      out.write(&bytes, sizeof bytes);
      out.write(array->bytes.data(), array->bytes.size());
    }
  out.write("\n  </AppendedData>\n</VTKFile>\n");
  out.commit();
}

}  // namespace hexaplast::output
