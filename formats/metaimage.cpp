// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <bit>

#include "hexaplast/base/error.hpp"
#include "volume_source.hpp"

// MetaImage: lines "Field = value", of which the last one says where the data are. Coordinates are LPS, lengths in mm.

namespace hexaplast {
namespace {

const std::map<std::string, NumberType>& metaimage_types() {
  static const std::map<std::string, NumberType> all{{"met_char", {1, true}},        {"met_uchar", {1, false}},
                                                     {"met_short", {2, true}},       {"met_ushort", {2, false}},
                                                     {"met_int", {4, true}},         {"met_uint", {4, false}},
                                                     {"met_long_long", {8, true}},   {"met_ulong_long", {8, false}},
                                                     {"met_float", {4, true, true}}, {"met_double", {8, true, true}}};
  return all;
}

const std::map<std::string, bool>& truth() {
  static const std::map<std::string, bool> all{{"true", true}, {"false", false}};
  return all;
}

const char* const kLast = "ElementDataFile";

class MetaImageFile {
 public:
  MetaImageFile(std::string_view content, const std::string& name) : content_(content), name_(name), header_(name) {}

  ImportedVolume read(const ReadBeside& beside, const VoxelCells& planned) {
    const std::string_view attached = read_header();
    header_.value("NDims");
    header_.expect("ObjectType", "Image");
    header_.expect("NDims", "3");
    header_.expect("BinaryData", "True");
    header_.expect("HeaderSize", "0");
    header_.expect("ElementNumberOfChannels", "1");
    header_.expect("DistanceUnits", "mm");
    const VolumeGeometry geometry = read_geometry();
    NumberType type = header_.one_of("ElementType", metaimage_types());
    const bool is_big = is_true("BinaryDataByteOrderMSB", is_true("ElementByteOrderMSB", false));
    if (header_.find("ElementByteOrderMSB") && is_big != is_true("ElementByteOrderMSB", false))
      header_.refuse("ElementByteOrderMSB", "must agree with BinaryDataByteOrderMSB");
    type.swaps_bytes = type.bytes > 1 && is_big != (std::endian::native == std::endian::big);

    std::string data;
    const bool is_detached = in_small_letters(header_.value(kLast)) != "local";
    if (is_detached) data = header_.data_beside(kLast, beside);
    ByteSource source(is_detached ? std::string_view(data) : attached, is_true("CompressedData", false), name_);
    ImportedVolume found{.volume = volume_of(geometry, type, source, name_)};
    read_voxels(source, type, name_, planned, found.volume);
    return found;
  }

 private:
  /// Returns what is behind the header.
  std::string_view read_header() {
    MeshSource source(content_.substr(0, kMaxHeader), name_);
    for (long line = 1;; ++line) {
      if (source.at_end()) header_.refuse_line(line, fmt::format("the file ends in its header: {} must follow", kLast));
      const std::string_view text = source.line();
      if (source.at_end() && content_.size() > kMaxHeader) header_.refuse_length(line);
      const std::size_t equals = text.find('=');
      if (equals == text.npos) header_.refuse_line(line, "must be 'Field = value'");
      const std::string_view field = without_blanks(text.substr(0, equals));
      header_.add(field, without_blanks(text.substr(equals + 1)), line);
      if (in_small_letters(field) == in_small_letters(kLast))
        return content_.substr(std::min(content_.size(), kMaxHeader) - source.remaining());
    }
  }

  VolumeGeometry read_geometry() const {
    VolumeGeometry geometry;
    geometry.size = header_.size("DimSize");
    const Vec3 spacing = header_.spacing("ElementSpacing");
    geometry.axes_field = "ElementSpacing";
    if (const char* field = given({"TransformMatrix", "Rotation", "Orientation"})) {
      geometry.axes_field = field;
      const std::vector<double> rows = header_.reals(field, 9);  // one direction after the other
      for (int d = 0; d < 3; ++d) {
        geometry.axes.col(d) = Vec3(rows.data() + 3 * d);
        if (std::abs(geometry.axes.col(d).norm() - 1) > kMaxErrorOfLength)
          header_.refuse(field,
                         fmt::format("direction {} has the length {:.6g}: must be 1", d, geometry.axes.col(d).norm()));
      }
    }
    geometry.axes = geometry.axes * spacing.asDiagonal();
    if (const char* field = given({"Offset", "Position", "Origin"}))
      geometry.origin = Vec3(header_.reals(field, 3).data());
    return geometry;
  }

  /// The name under which a field is there, of which there may be one alone; null: it is not.
  const char* given(std::initializer_list<const char*> names) const {
    const char* found = nullptr;
    for (const char* name : names) {
      if (!header_.find(name)) continue;
      if (found) header_.refuse(name, fmt::format("{} is given, too", found));
      found = name;
    }
    return found;
  }

  bool is_true(const char* field, bool otherwise) const {
    return header_.find(field) ? header_.one_of(field, truth()) : otherwise;
  }

  static constexpr double kMaxErrorOfLength = 1e-4;

  std::string_view content_;
  std::string name_;
  TextHeader header_;
};

}  // namespace

ImportedVolume parse_metaimage(std::string_view content, const std::string& name, const ReadBeside& beside,
                               const VoxelCells& planned) {
  return MetaImageFile(content, name).read(beside, planned);
}

}  // namespace hexaplast
