// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output/vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "hexaplast/base/error.hpp"
#include "output/files.hpp"

namespace hexaplast::output {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say LittleEndian and hold memory as it is");

constexpr std::uint8_t kVtkHexahedron = 12;

/// One array of the file: how the header describes it, and its bytes, which stay where they are until they are written.
struct Array {
  std::string_view type;
  std::string_view name;
  int components;
  std::span<const std::byte> bytes;
};

template <class Number>
Array scalars(std::string_view type, std::string_view name, const std::vector<Number>& values) {
  return {type, name, 1, std::as_bytes(std::span(values))};
}

Array vectors(std::string_view name, const PointArray& field) {
  return {"Float64", name, 3, std::as_bytes(std::span(field.data(), static_cast<std::size_t>(field.size())))};
}

/// Writes the header's elements and hands out the offsets of the appended blocks: 8 bytes of length, then the data.
class Layout {
 public:
  std::string describe(std::span<const Array> arrays) {
    std::string text;
    for (const Array& array : arrays) {
      const std::string shape = array.components > 1 ? fmt::format(" NumberOfComponents=\"{}\"", array.components) : "";
      text += fmt::format("        <DataArray type=\"{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n",
                          array.type, array.name, shape, offset_);
      offset_ += sizeof(std::uint64_t) + array.bytes.size();
    }
    return text;
  }

 private:
  std::uint64_t offset_ = 0;
};

}  // namespace

void write_vtu(const std::filesystem::path& file, const Body& body, ConstPoints positions, ConstPoints velocities) {
  const HexMesh& mesh = body.mesh();
  const PointArray world = positions;
  const PointArray displacement = positions - mesh.positions();
  const PointArray velocity = velocities;
  ElementFields fields = body.fields(positions);

  // removed hexahedra are not shown
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  std::vector<std::int32_t> ids(hexahedra.size());
  std::iota(ids.begin(), ids.end(), 0);
  const auto keep_alive = [&](auto& values) {
    std::size_t kept = 0;
    for (std::size_t e = 0; e < values.size(); ++e)
      if (body.history().alive[e]) values[kept++] = values[e];
    values.resize(kept);
  };
  keep_alive(hexahedra);
  keep_alive(ids);
  for (std::vector<double>* values :
       {&fields.plastic_strain, &fields.yield_stress, &fields.volume_ratio, &fields.stress_norm, &fields.strain})
    keep_alive(*values);

  const std::size_t num_cells = hexahedra.size();
  std::vector<std::int64_t> offsets(num_cells);
  for (std::size_t e = 0; e < num_cells; ++e) offsets[e] = kCorners * (static_cast<std::int64_t>(e) + 1);
  const std::vector<std::uint8_t> types(num_cells, kVtkHexahedron);
  const ConnectedParts parts = connected_parts(mesh, body.history().alive);
  std::vector<std::int32_t> part(num_cells);
  for (std::size_t e = 0; e < num_cells; ++e) part[e] = parts.part_of_node[hexahedra[e][0]];

  const std::vector<Array> points{vectors("Points", world)};
  const std::vector<Array> cells{{"Int32", "connectivity", 1, std::as_bytes(std::span(hexahedra))},
                                 scalars("Int64", "offsets", offsets),
                                 scalars("UInt8", "types", types)};
  const std::vector<Array> point_data{vectors("displacement", displacement),
                                      vectors("material_position", body.history().material),
                                      vectors("velocity", velocity)};
  const std::vector<Array> cell_data{scalars("Int32", "id", ids),
                                     scalars("Int32", "part", part),
                                     scalars("Float64", "stress_norm", fields.stress_norm),
                                     scalars("Float64", "plastic_strain", fields.plastic_strain),
                                     scalars("Float64", "yield_stress", fields.yield_stress),
                                     scalars("Float64", "volume_ratio", fields.volume_ratio),
                                     scalars("Float64", "strain", fields.strain)};

  Layout layout;
  std::string header =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n";
  header += fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", mesh.num_nodes(), num_cells);
  header += "      <Points>\n" + layout.describe(points) + "      </Points>\n";
  header += "      <Cells>\n" + layout.describe(cells) + "      </Cells>\n";
  header += "      <PointData>\n" + layout.describe(point_data) + "      </PointData>\n";
  header += "      <CellData Scalars=\"plastic_strain\">\n" + layout.describe(cell_data) + "      </CellData>\n";
  header += "    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";

  WholeFile out(file);
  out.write(header);
  for (const auto& group : {points, cells, point_data, cell_data})
    for (const Array& array : group) {
      const std::uint64_t bytes = array.bytes.size();
      out.write(&bytes, sizeof bytes);
      out.write(array.bytes.data(), array.bytes.size());
    }
  out.write("\n  </AppendedData>\n</VTKFile>\n");
  out.commit();
}

void TimeSeries::add(double time, const std::string& vtu) {
  std::vector<Entry> entries = entries_;
  entries.push_back({time, vtu});
  write(entries);
  entries_ = std::move(entries);
}

void TimeSeries::serialize(Archive& archive) {
  std::uint64_t count = entries_.size();
  archive(count);
  if (archive.reads()) {
    if (count > archive.rest()) throw InputError(fmt::format("{} states are announced", count));
    entries_.resize(count);
  }
  for (Entry& entry : entries_) archive(entry.time, entry.vtu);
}

void TimeSeries::keep(const std::function<bool(const std::string&)>& is_wanted) {
  std::erase_if(entries_, [&](const Entry& entry) { return !is_wanted(entry.vtu); });
  write(entries_);
}

bool TimeSeries::has(const std::string& vtu) const {
  return std::ranges::find(entries_, vtu, &Entry::vtu) != entries_.end();
}

void TimeSeries::write(const std::vector<Entry>& entries) const {
  WholeFile out(file_);
  out.write(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n");
  for (const Entry& entry : entries)
    out.write(fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.time, entry.vtu));
  out.write("  </Collection>\n</VTKFile>\n");
  out.commit();
}

}  // namespace hexaplast::output
