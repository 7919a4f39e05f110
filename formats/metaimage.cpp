// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <bit>

#include "hexaplast/base/error.hpp"
#include "volume_source.hpp"

// MetaImage: lines "Field = value", of which the last one says where the data are. Coordinates are LPS, lengths in mm.

namespace hexaplast {
namespace {

const char* const kLast = "ElementDataFile";

class MetaImageFile {
 public:
  MetaImageFile(std::string_view content, const std::string& name) : name_(name), header_(content, name) {}

  ImportedVolume read(const ReadBeside& beside, const VoxelCells& planned) {
    read_header();
    header_.value("NDims");
    header_.expect("ObjectType", "Image");
    header_.expect("NDims", "3");
    header_.expect("BinaryData", "True");
    header_.expect("HeaderSize", "0");
    header_.expect("ElementNumberOfChannels", "1");
    header_.expect("DistanceUnits", "mm");
    const VolumeGeometry geometry = read_geometry();
    NumberType type = header_.one_of<NumberType>("ElementType", {{"met_char", {1, true}},
                                                                 {"met_uchar", {1}},
                                                                 {"met_short", {2, true}},
                                                                 {"met_ushort", {2}},
                                                                 {"met_int", kInt32},
                                                                 {"met_uint", {4}},
                                                                 {"met_long_long", kInt64},
                                                                 {"met_ulong_long", {8}},
                                                                 {"met_float", {4, true, true}},
                                                                 {"met_double", {8, true, true}}});
    const bool is_big = is_true("BinaryDataByteOrderMSB", is_true("ElementByteOrderMSB", false));
    if (header_.find("ElementByteOrderMSB") && is_big != is_true("ElementByteOrderMSB", false))
      header_.refuse("ElementByteOrderMSB", "must agree with BinaryDataByteOrderMSB");
    type.swaps_bytes = type.bytes > 1 && is_big != (std::endian::native == std::endian::big);

    std::string data;
    const bool is_detached = in_small_letters(header_.value(kLast)) != "local";
    if (is_detached) data = header_.data_beside(kLast, beside);
    ByteSource source(is_detached ? data : header_.rest(), is_true("CompressedData", false), name_);
    return {.volume = read_voxels(geometry, type, source, name_, planned)};
  }

 private:
  void read_header() {
    for (std::string_view text; !header_.find(kLast);) {
      if (!header_.next_line(text))
        header_.refuse_line(fmt::format("the file ends in its header: {} must follow", kLast));
      const std::size_t equals = text.find('=');
      if (equals == text.npos) header_.refuse_line("must be 'Field = value'");
      header_.add(without_blanks(text.substr(0, equals)), without_blanks(text.substr(equals + 1)));
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
    return header_.find(field) ? header_.one_of<bool>(field, {{"true", true}, {"false", false}}) : otherwise;
  }

  static constexpr double kMaxErrorOfLength = 1e-4;

  std::string name_;
  TextHeader header_;
};

}  // namespace

ImportedVolume parse_metaimage(std::string_view content, const std::string& name, const ReadBeside& beside,
                               const VoxelCells& planned) {
  return MetaImageFile(content, name).read(beside, planned);
}

}  // namespace hexaplast
