// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "mesh_source.hpp"

// VTK's legacy file format. Binary numbers are big-endian.

namespace hexaplast {
namespace {

class LegacyVtkFile {
 public:
  LegacyVtkFile(std::string_view content, const std::string& name) : source_(content, name) {
    source_.swaps_bytes = std::endian::native == std::endian::little;
  }

  ImportedMesh read() {
    read_head();
    while (true) {
      const std::string_view section = source_.word();
      if (section.empty() || section == "POINT_DATA" || section == "CELL_DATA") break;
      if (section == "POINTS")
        read_points();
      else if (section == "CELLS")
        read_cells();
      else if (section == "CELL_TYPES")
        read_cell_types();
      else if (section == "FIELD")
        skip_field();
      else if (section == "METADATA")
        skip_metadata();
      else
        source_.refuse(fmt::format("section '{}' is not known", excerpt(section)));
    }
    if (!has_points_) source_.refuse("the file ends without POINTS");
    if (!has_cells_) source_.refuse("the file ends without CELLS");
    add_cells();
    merge_copies(mesh_);
    return std::move(mesh_);
  }

 private:
  void read_head() {
    const std::string_view first = source_.line();
    if (!first.starts_with("# vtk DataFile Version"))
      source_.refuse("the file does not begin with '# vtk DataFile Version' and is no XML");
    source_.line();  // title
    const std::string_view form = source_.word();
    source_.is_binary = form == "BINARY";
    if (!source_.is_binary && form != "ASCII") source_.refuse("the third line is neither ASCII nor BINARY");
    source_.expect("DATASET");
    if (source_.word() != "UNSTRUCTURED_GRID") source_.refuse("the data set must be an UNSTRUCTURED_GRID");
  }

  void read_points() {
    if (std::exchange(has_points_, true)) source_.refuse("a second POINTS, there must be one");
    const std::size_t count = source_.count("the number of points", source_.is_binary ? 3 : 5);
    const NumberType type = next_type("of numbers is not known");
    begin_data(3 * count, type, "the number of points");
    if (count > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      source_.refuse(fmt::format("{} points, must be at most {}", count, std::numeric_limits<int>::max()));
    mesh_.positions.resize(static_cast<Eigen::Index>(count), 3);
    for (Eigen::Index i = 0; i < mesh_.positions.size(); ++i) mesh_.positions.data()[i] = real(type);
  }

  // Up to version 5: for each cell how many points, and which. From then on: where each cell begins, and all points.
  void read_cells() {
    if (std::exchange(has_cells_, true)) source_.refuse("a second CELLS, there must be one");
    const std::size_t bytes = source_.is_binary ? 4 : 2, count = source_.count("the number of cells", bytes),
                      size = source_.count("the size of the cells", bytes);
    MeshSource ahead = source_;
    if (ahead.word() == "OFFSETS") {
      source_.word();
      offsets_ = integers(count);
      source_.expect("CONNECTIVITY");
      connectivity_ = integers(size);
      if (offsets_.empty()) offsets_ = {0};
    } else {
      begin_data(size, kInt32, "the size of the cells");
      offsets_ = {0};
      std::size_t left = size;
      for (std::size_t e = 0; e < count; ++e) {
        const std::int64_t num_points = left == 0 ? -1 : integer(kInt32);
        if (num_points < 0 || static_cast<std::size_t>(num_points) > --left)
          source_.refuse_data(fmt::format("cell {} does not fit into the size of the cells, which is {}", e, size));
        for (std::int64_t a = 0; a < num_points; ++a) connectivity_.push_back(integer(kInt32));
        left -= static_cast<std::size_t>(num_points);
        offsets_.push_back(static_cast<std::int64_t>(connectivity_.size()));
      }
      if (left != 0)
        source_.refuse_data(fmt::format("{} cells leave {} numbers of the size of the cells over", count, left));
    }
  }

  void read_cell_types() {
    const std::size_t count = source_.count("the number of cell types", source_.is_binary ? 4 : 1);
    begin_data(count, kInt32, "the number of cell types");
    for (std::size_t e = 0; e < count; ++e) types_.push_back(integer(kInt32));
  }

  std::vector<std::int64_t> integers(std::size_t count) {
    const NumberType type = next_type("of numbers is not known");
    begin_data(count, type, "the number of entries");
    std::vector<std::int64_t> numbers(count);
    for (std::int64_t& number : numbers) number = integer(type);
    return numbers;
  }

  /// Arrays that belong to the data set as a whole.
  void skip_field() {
    source_.word();
    const std::size_t num_arrays = source_.count("the number of arrays", 4);
    for (std::size_t i = 0; i < num_arrays; ++i) {
      source_.word();
      const std::size_t components = source_.count("the number of components", 1);
      const std::size_t tuples = source_.count("the number of tuples", 1);
      const NumberType type = next_type("cannot be read here");
      if (components != 0 && tuples > source_.remaining() / components)
        source_.refuse(fmt::format("{} x {} values, the rest of the file has room for {}", components, tuples,
                                   source_.remaining()));
      begin_data(components * tuples, type, "the number of values");
      if (source_.is_binary)
        source_.skip(components * tuples * type.bytes);
      else
        for (std::size_t k = 0; k < components * tuples; ++k) source_.word();
    }
  }

  /// Goes on for lines until an empty one.
  void skip_metadata() {
    source_.line();
    while (!source_.at_end() && !source_.line().empty()) {
    }
  }

  void add_cells() {
    const std::size_t num_cells = offsets_.empty() ? 0 : offsets_.size() - 1;
    if (types_.size() != num_cells)
      source_.refuse_data(fmt::format("{} cell types for {} cells, must be as many", types_.size(), num_cells));
    for (std::size_t e = 0; e < num_cells; ++e) {
      const std::int64_t begin = offsets_[e], end = offsets_[e + 1];
      if (begin < 0 || end < begin || end > static_cast<std::int64_t>(connectivity_.size()))
        source_.refuse_data(
            fmt::format("cell {} lies between {} and {} of {} entries", e, begin, end, connectivity_.size()));
      for (std::int64_t a = begin; a < end; ++a)
        if (connectivity_[a] < 0 || connectivity_[a] >= mesh_.positions.rows())
          source_.refuse_data(
              fmt::format("cell {} has point {}, must lie in [0, {})", e, connectivity_[a], mesh_.positions.rows()));
      if (!add_vtk_cell(static_cast<int>(types_[e]), connectivity_.data() + begin,
                        static_cast<std::size_t>(end - begin), mesh_))
        source_.refuse_data(fmt::format("cell {} is of type {} and has {} points", e, types_[e], end - begin));
    }
  }

  NumberType next_type(const char* otherwise) {
    static const std::map<std::string_view, NumberType> kTypes{{"double", {8, true, true}},
                                                               {"float", {4, true, true}},
                                                               {"long", kInt64},
                                                               {"vtktypeint64", kInt64},
                                                               {"int", kInt32},
                                                               {"vtktypeint32", kInt32},
                                                               {"unsigned_int", {4}},
                                                               {"short", {2, true}},
                                                               {"unsigned_short", {2}},
                                                               {"char", {1, true}},
                                                               {"unsigned_char", {1}}};
    const std::string_view name = source_.word();
    if (const auto known = kTypes.find(name); known != kTypes.end()) return known->second;
    source_.refuse(fmt::format("type '{}' {}", excerpt(name), otherwise));
  }

  /// Binary numbers begin on the next line, and must be there in full.
  void begin_data(std::size_t count, const NumberType& type, const char* what) {
    if (!source_.is_binary) return;
    source_.line();
    source_.checked_count(count, what, type.bytes);
  }

  double real(const NumberType& type) {
    if (!source_.is_binary) return source_.real("a coordinate");
    const auto number = source_.binary<double>(type);
    if (!std::isfinite(number)) source_.refuse_at_byte(fmt::format("{} is not a coordinate: must be finite", number));
    return number;
  }

  std::int64_t integer(const NumberType& type) { return source_.number(type, "a whole number"); }

  MeshSource source_;
  ImportedMesh mesh_;
  bool has_points_ = false, has_cells_ = false;
  std::vector<std::int64_t> offsets_, connectivity_,
      types_;  // cell e has the entries from offsets_[e] to offsets_[e + 1]
};

}  // namespace

ImportedMesh parse_vtk(std::string_view content, const std::string& name) {
  const bool is_xml = without_blanks(content).starts_with('<');
  return is_xml ? parse_vtu(content, name) : LegacyVtkFile(content, name).read();
}

}  // namespace hexaplast
