// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "formats/base64.hpp"
#include "formats/xml.hpp"
#include "hexaplast/base/error.hpp"
#include "mesh_source.hpp"
#include "vtu_grid.hpp"

// VTK's XML files of unstructured grids. A data array is text; or bytes in base64, in place or appended; or raw bytes,
// appended. Bytes follow their number, or, compressed, the sizes of their blocks.

namespace hexaplast {
namespace {

constexpr std::int64_t kMaxComponents = 4096;  // of a data array
constexpr std::size_t kMaxGrowth = 1032;       // no byte of zlib's stands for more than this many

// What the numbers of a file may take altogether, beside the bytes that they are decoded from: a regular grid, which
// zlib packs best, takes eight bytes per byte of its data.
constexpr std::size_t kMaxBytesPerByte = 16;
constexpr std::size_t kBytesOfAnyFile = 24'000'000;  // [byte]

class VtuFile {
 public:
  VtuFile(std::string_view content, std::string name) : content_(content), name_(std::move(name)) {}

  ImportedState read(bool with_data) {
    reads_data_ = with_data;
    XmlDocument document;
    try {
      document = parse_xml(content_, {}, "AppendedData");
    } catch (const XmlError& error) {
      refuse_line(error.line(), error.what());
    }
    const XmlElement& root = document.root;
    if (root.name != "VTKFile") refuse_line(1, "the root element must be VTKFile");
    if (root.attribute("type") != "UnstructuredGrid")
      refuse(root, fmt::format("type '{}', must be UnstructuredGrid", root.attribute("type")));
    if (const XmlElement* appended = root.child("AppendedData")) {
      const std::size_t marker = appended->content.find('_'), end = appended->content.rfind("</AppendedData>");
      if (marker == content_.npos || end == content_.npos || end < marker)
        refuse(*appended, "must hold '_', its data, and an end");
      appended_ = appended->content.substr(marker + 1, end - marker - 1);
      appended_is_raw_ = appended->attribute("encoding") != "base64";
    }
    read_conventions(root);

    const XmlElement& grid = child(root, "UnstructuredGrid");
    child(grid, "Piece");  // one at least
    if (const XmlElement* data = grid.child("FieldData"))
      for (const XmlElement& array : data->children) state_.field_names.emplace_back(array.attribute("Name"));
    if (reads_data_) add_data(grid, "FieldData", std::nullopt, state_.field_data);
    state_.mesh.is_of_patient = std::ranges::find(state_.field_names, kOfPatient) != state_.field_names.end();
    for (const XmlElement& piece : grid.children)
      if (piece.name == "Piece") add_piece(piece);
    const std::vector<int> number = merge_copies(state_.mesh);
    std::vector<int> cells(state_.mesh.hexahedra.size());
    for (std::size_t e = number.size(); e-- > 0;) cells[number[e]] = state_.hexahedron_cells[e];
    state_.hexahedron_cells = std::move(cells);
    state_.mesh.positions = points_of(coordinates_);
    return std::move(state_);
  }

 private:
  void read_conventions(const XmlElement& root) {
    const std::string_view order = root.attribute("byte_order"), header = root.attribute("header_type"),
                           compressor = root.attribute("compressor");
    if (order != "LittleEndian" && order != "BigEndian")
      refuse(root, fmt::format("byte_order '{}', must be LittleEndian or BigEndian", order));
    swaps_bytes_ = (order == "LittleEndian") != (std::endian::native == std::endian::little);
    if (!header.empty() && header != "UInt32" && header != "UInt64")
      refuse(root, fmt::format("header_type '{}', must be UInt32 or UInt64", header));
    header_bytes_ = header == "UInt64" ? 8 : 4;
    is_compressed_ = !compressor.empty();
    if (is_compressed_ && compressor != "vtkZLibDataCompressor")
      refuse(root, fmt::format("compressor '{}', must be vtkZLibDataCompressor or none", compressor));
  }

  void add_piece(const XmlElement& piece) {
    const std::size_t num_points = counted(piece, "NumberOfPoints"), num_cells = counted(piece, "NumberOfCells");
    const std::size_t before = coordinates_.size() / 3;
    if (before + num_points > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      refuse(piece, "more points than can be numbered");

    const XmlElement& points = child(child(piece, "Points"), "DataArray");
    std::vector<double> x = numbers<double>(points, 3 * num_points);
    for (const double number : x)
      if (!std::isfinite(number))
        refuse(points, fmt::format("{} is not a coordinate: must be a finite number", number));
    if (before == 0)
      coordinates_ = std::move(x);
    else
      coordinates_.insert(coordinates_.end(), x.begin(), x.end());
    if (num_cells > 0) add_cells(child(piece, "Cells"), num_points, num_cells, static_cast<std::int64_t>(before));
    if (!reads_data_) return;
    if (std::exchange(has_data_, true)) refuse(piece, "data of several pieces are not read: must be the only one");
    add_data(piece, "PointData", num_points, state_.point_data);
    add_data(piece, "CellData", num_cells, state_.cell_data);
  }

  /// count: of points or cells; none: each array has its own.
  void add_data(const XmlElement& parent, const char* group, std::optional<std::size_t> count,
                std::vector<ImportedArray>& arrays) {
    const XmlElement* data = parent.child(group);
    if (!data) return;
    for (const XmlElement& at : data->children) {
      if (at.name != "DataArray" || at.attribute("type") == "String") continue;
      if (!count && at.attribute("NumberOfTuples").empty()) continue;
      ImportedArray array{std::string(at.attribute("Name")), 1, {}};
      const std::string_view components = at.attribute("NumberOfComponents");
      if (std::int64_t number = 1; !components.empty()) {
        if (!read_number(components, number) || number < 1 || number > kMaxComponents)
          refuse(at, fmt::format("NumberOfComponents '{}', must lie in [1, {}]", components, kMaxComponents));
        array.num_components = static_cast<int>(number);
      }
      const std::size_t size =
          (count ? *count : counted(at, "NumberOfTuples")) * static_cast<std::size_t>(array.num_components);
      if (array_type(at).is_real) {
        array.values = numbers<double>(at, size);
      } else {
        const std::vector<std::int64_t> whole = numbers<std::int64_t>(at, size);
        array.values.assign(whole.begin(), whole.end());
      }
      arrays.push_back(std::move(array));
    }
  }

  void add_cells(const XmlElement& cells, std::size_t num_points, std::size_t num_cells, std::int64_t first_point) {
    const XmlElement &ends_at = array(cells, "offsets"), &types_at = array(cells, "types");
    const std::vector<std::int64_t> ends = numbers<std::int64_t>(ends_at, num_cells);
    const std::vector<std::int64_t> types = numbers<std::int64_t>(types_at, num_cells);
    // what a cell has is known before its points are read: they are not unpacked for cells that cannot be
    for (std::size_t e = 0; e < num_cells; ++e) {
      const std::int64_t begin = e == 0 ? 0 : ends[e - 1];
      if (ends[e] < begin) refuse(ends_at, fmt::format("cell {} ends before it begins", e));
      if (const std::size_t corners = corners_of_vtk_cell(kind_of(types[e]));
          corners != 0 && static_cast<std::size_t>(ends[e] - begin) != corners)
        refuse(types_at, fmt::format("cell {} is of type {} and has {} points", e, types[e], ends[e] - begin));
    }

    const XmlElement& nodes_at = array(cells, "connectivity");
    std::vector<std::int64_t> nodes = numbers<std::int64_t>(nodes_at, static_cast<std::size_t>(ends.back()));
    for (std::int64_t& node : nodes) {
      if (node < 0 || node >= static_cast<std::int64_t>(num_points))
        refuse(nodes_at, fmt::format("point {}, must lie in [0, {})", node, num_points));
      node += first_point;
    }
    for (std::size_t e = 0; e < num_cells; ++e) {
      const std::int64_t begin = e == 0 ? 0 : ends[e - 1];
      const std::size_t num_hexahedra = state_.mesh.hexahedra.size();
      add_vtk_cell(kind_of(types[e]), nodes.data() + begin, static_cast<std::size_t>(ends[e] - begin), state_.mesh);
      if (state_.mesh.hexahedra.size() > num_hexahedra) state_.hexahedron_cells.push_back(static_cast<int>(e));
    }
  }

  static int kind_of(std::int64_t type) { return static_cast<int>(std::clamp<std::int64_t>(type, 0, 255)); }

  // Data arrays
  // -----------------------------------------------------------------------------------------------------------------

  /// All numbers of an array, of which there must be `count`.
  template <class Number>
  std::vector<Number> numbers(const XmlElement& at, std::size_t count) {
    num_numbers_ += std::min(count, std::numeric_limits<std::size_t>::max() - num_numbers_);
    const std::string_view format = at.attribute("format");
    if (format == "ascii") return numbers_of_text<Number>(at, count);

    const NumberType type = array_type(at);
    if (count > std::numeric_limits<std::size_t>::max() / type.bytes)
      refuse(at, "more values than the file has room for");
    const std::size_t size = count * type.bytes;
    std::string bytes;
    if (format == "appended") {
      std::int64_t offset = 0;
      if (!read_number(at.attribute("offset"), offset) || offset < 0 ||
          static_cast<std::size_t>(offset) > appended_.size())
        refuse(at, fmt::format("offset '{}', must lie in [0, {}]", at.attribute("offset"), appended_.size()));
      bytes = decoded(at, appended_.substr(static_cast<std::size_t>(offset)), appended_is_raw_, size);
    } else if (format == "binary") {
      bytes = decoded(at, without_blanks(at.content), false, size);
    } else {
      refuse(at, fmt::format("format '{}', must be ascii, binary or appended", format));
    }
    return numbers_of_bytes<Number>(at, bytes, type);
  }

  template <class Number>
  std::vector<Number> numbers_of_text(const XmlElement& at, std::size_t count) {
    MeshSource text(at.content, name_);
    take(at, text.remaining());
    if (count > (text.remaining() + 1) / 2) refuse(at, fmt::format("holds less than {} numbers", count));
    std::vector<Number> all(count);
    for (Number& number : all) {
      const std::string_view word = text.word();
      if (word.empty()) refuse(at, fmt::format("holds less than {} numbers", count));
      if (!read_value(word, number)) refuse(at, fmt::format("'{}' is not a number of this kind", excerpt(word)));
    }
    if (!text.word().empty()) refuse(at, fmt::format("holds more than {} numbers", count));
    return all;
  }

  template <class Number>
  std::vector<Number> numbers_of_bytes(const XmlElement& at, std::string_view bytes, const NumberType& type) {
    if (type.is_real != std::is_floating_point_v<Number>) refuse(at, "real numbers and whole numbers are mixed up");
    std::vector<Number> all(bytes.size() / type.bytes);
    MeshSource source(bytes, name_);
    source.swaps_bytes = swaps_bytes_;
    for (Number& number : all) number = source.binary<Number>(type);
    return all;
  }

  /// The `size` bytes that data stand for.
  std::string decoded(const XmlElement& at, std::string_view data, bool is_raw, std::size_t size) {
    if (!is_compressed_) {
      const std::string head = part(at, data, is_raw, 0, header_bytes_);
      if (header(head, 0) != size) refuse(at, fmt::format("{} bytes, must be {}", header(head, 0), size));
      take(at, header_bytes_ + size);
      // without compression number and bytes are encoded in one
      return part(at, data, is_raw, 0, header_bytes_ + size).substr(header_bytes_);
    }

    const std::string start = part(at, data, is_raw, 0, 3 * header_bytes_);
    const std::uint64_t num_blocks = header(start, 0), block = header(start, 1), last = header(start, 2);
    if (num_blocks > data.size() / header_bytes_)
      refuse(at, fmt::format("{} blocks, the data have room for {}", num_blocks, data.size() / header_bytes_));
    if (num_blocks == 0 && size == 0) return {};
    const std::uint64_t whole_blocks = last == 0 ? num_blocks : num_blocks - 1;
    const bool fits = num_blocks > 0 && last <= size && (whole_blocks == 0 || block <= size / whole_blocks) &&
                      whole_blocks * block + last == size;
    if (!fits)
      refuse(at, fmt::format("{} blocks of {} bytes, the last of {}, are not {} bytes", num_blocks, block, last, size));

    const std::size_t head_size = (3 + num_blocks) * header_bytes_;
    const std::string head = part(at, data, is_raw, 0, head_size);
    std::string bytes;
    std::size_t total = 0;
    for (std::uint64_t i = 0; i < num_blocks; ++i) {
      if (header(head, 3 + i) > data.size()) refuse(at, "a compressed block is larger than the data");
      total += header(head, 3 + i);
    }
    take(at, head_size + total);
    const std::string packed = part(at, data, is_raw, head_size, total);
    if (size / kMaxGrowth > packed.size()) refuse(at, fmt::format("{} bytes cannot come from {}", size, packed.size()));

    bytes.resize(size);
    std::size_t from = 0, to = 0;
    for (std::uint64_t i = 0; i < num_blocks; ++i) {
      const std::size_t packed_size = header(head, 3 + i);
      uLongf unpacked = i < whole_blocks ? block : last;
      const uLongf wanted = unpacked;
      const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data() + to), &unpacked,
                                    reinterpret_cast<const Bytef*>(packed.data() + from), packed_size);
      if (status != Z_OK || unpacked != wanted)
        refuse(at, fmt::format("block {} of the compressed data is damaged", i));
      from += packed_size;
      to += wanted;
    }
    return bytes;
  }

  // Every byte of the file belongs to one array: many that name the same ones would multiply them. And few compressed
  // bytes must not become many numbers.
  void take(const XmlElement& at, std::size_t bytes) {
    if (bytes > content_.size() - num_taken_) refuse(at, "takes bytes that belong to other arrays");
    num_taken_ += bytes;
    const std::size_t max = (kBytesOfAnyFile + kMaxBytesPerByte * num_taken_) / sizeof(double);
    if (num_numbers_ > max)
      refuse(at,
             fmt::format("{} numbers so far: {} bytes of data can contain at most {}", num_numbers_, num_taken_, max));
  }

  /// `size` bytes of data: raw from byte `begin` on; in base64 those of the part that begins where the base64 of the
  /// first `begin` bytes ends, each part being padded.
  std::string part(const XmlElement& at, std::string_view data, bool is_raw, std::size_t begin, std::size_t size) {
    const auto cut = [&](std::size_t from, std::size_t length) {
      if (from > data.size() || length > data.size() - from)
        refuse(at, "the file ends in the middle of the data, or they are shorter than their header says");
      return data.substr(from, length);
    };
    if (is_raw) return std::string(cut(begin, size));
    const auto encoded = [](std::size_t bytes) { return (bytes / 3 + (bytes % 3 != 0)) * 4; };
    std::string bytes = decoded(at, cut(encoded(begin), encoded(size)));
    bytes.resize(size);
    return bytes;
  }

  std::string decoded(const XmlElement& at, std::string_view text) const {
    std::optional<std::string> bytes = from_base64(text);
    if (!bytes) refuse(at, "holds something that is not base64");
    return std::move(*bytes);
  }

  std::uint64_t header(std::string_view bytes, std::size_t entry) const {
    const char* at = bytes.data() + entry * header_bytes_;
    return number_at<std::uint64_t>(at, {header_bytes_}, swaps_bytes_);
  }

  // Elements
  // -----------------------------------------------------------------------------------------------------------------

  std::size_t counted(const XmlElement& element, const char* name) const {
    std::int64_t number = 0;
    if (!read_number(element.attribute(name), number) || number < 0)
      refuse(element, fmt::format("{} '{}', must be a whole number >= 0", name, element.attribute(name)));
    if (static_cast<std::uint64_t>(number) / kMaxGrowth > content_.size())
      refuse(element, fmt::format("{} is {}, more than the file has room for", name, number));
    return static_cast<std::size_t>(number);
  }

  const XmlElement& child(const XmlElement& element, const char* name) const {
    const XmlElement* found = element.child(name);
    if (!found) refuse(element, fmt::format("holds no {}", name));
    return *found;
  }

  const XmlElement& array(const XmlElement& cells, const char* name) const {
    for (const XmlElement& at : cells.children)
      if (at.name == "DataArray" && at.attribute("Name") == name) return at;
    refuse(cells, fmt::format("holds no array '{}'", name));
  }

  NumberType array_type(const XmlElement& at) const {
    const std::string_view type = at.attribute("type");
    static const std::map<std::string_view, NumberType> kTypes{{"Float64", {8, true, true}},
                                                               {"Float32", {4, true, true}},
                                                               {"Int64", {8, true}},
                                                               {"Int32", {4, true}},
                                                               {"Int16", {2, true}},
                                                               {"Int8", {1, true}},
                                                               {"UInt64", {8}},
                                                               {"UInt32", {4}},
                                                               {"UInt16", {2}},
                                                               {"UInt8", {1}}};
    if (const auto known = kTypes.find(type); known != kTypes.end()) return known->second;
    refuse(at, fmt::format("type '{}' of numbers is not known", type));
  }

  [[noreturn]] void refuse(const XmlElement& element, const std::string& what) const {
    refuse_line(element.line, fmt::format("{}: {}", element.name, what));
  }
  [[noreturn]] void refuse_line(int line, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", name_, line, what));
  }

  std::string_view content_;
  std::string name_;
  ImportedState state_;
  std::vector<double> coordinates_;  // [m] of all points so far
  std::size_t num_numbers_ = 0;      // of all arrays so far
  std::size_t num_taken_ = 0;        // [byte] by them
  bool reads_data_ = false, has_data_ = false;
  std::string_view appended_;
  bool appended_is_raw_ = true;
  bool swaps_bytes_ = false, is_compressed_ = false;
  std::size_t header_bytes_ = 4;
};

}  // namespace

ImportedMesh parse_vtu(std::string_view content, const std::string& name) {
  return VtuFile(content, name).read(false).mesh;
}

ImportedState parse_vtu_state(std::string_view content, const std::string& name) {
  return VtuFile(content, name).read(true);
}

ImportedState read_vtu_state(const std::filesystem::path& file) {
  return parse_vtu_state(whole_file(file), file.string());
}

}  // namespace hexaplast
