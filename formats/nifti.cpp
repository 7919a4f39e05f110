// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "hexaplast/base/error.hpp"
#include "volume_source.hpp"

// NIfTI-1 in one file: a header of 348 bytes, extensions, and the data. Coordinates are RAS.

namespace hexaplast {
namespace {

constexpr std::size_t kNiftiHeader = 348, kMinOffset = 352;  // [byte]
constexpr double kMaxOffset = 1 << 26;                       // [byte] of extensions
constexpr double kMinScalar = 1e-7;                          // of a quaternion: below, it turns by 180 degrees

class NiftiFile {
 public:
  NiftiFile(std::string_view content, const std::string& name)
      : name_(name), source_(content, is_gzip(content), name) {}

  ImportedVolume read(const VoxelCells& planned) {
    source_.read(header_, kNiftiHeader);
    read_byte_order();
    if (std::memcmp(header_ + 344, "ni1", 4) == 0)
      refuse("magic", "data in a second file (.img) are not read: must be one file (.nii)");
    if (std::memcmp(header_ + 344, "n+1", 4) != 0) refuse("magic", "must be 'n+1'");

    VolumeGeometry geometry;
    read_size(geometry);
    const NumberType type = read_type();
    const bool has_frame = read_axes(geometry);
    skip_extensions();
    return {.volume = read_voxels(geometry, type, source_, name_, planned), .has_frame = has_frame};
  }

 private:
  [[noreturn]] void refuse(const std::string& field, const std::string& what) const {
    throw InputError(fmt::format("{}: {}: {}", name_, field, what));
  }

  template <class Number>
  Number at(std::size_t byte) const {
    return number_at<Number>(header_ + byte, swaps_bytes_);
  }
  int whole(std::size_t byte) const { return at<std::int16_t>(byte); }
  double real(std::size_t byte, const std::string& field) const {
    const double number = at<float>(byte);
    if (!std::isfinite(number)) refuse(field, fmt::format("{}, must be a finite number", number));
    return number;
  }

  void read_byte_order() {
    const auto size = at<std::int32_t>(0);
    swaps_bytes_ = size != static_cast<std::int32_t>(kNiftiHeader);
    if (size == 540 || at<std::int32_t>(0) == 540) refuse("sizeof_hdr", "540 is NIfTI-2: must be 348, NIfTI-1");
    if (at<std::int32_t>(0) != static_cast<std::int32_t>(kNiftiHeader))
      refuse("sizeof_hdr", fmt::format("{}, must be {}", size, kNiftiHeader));
  }

  void read_size(VolumeGeometry& geometry) const {
    const int num_dimensions = whole(40);
    if (num_dimensions < 3 || num_dimensions > 7)
      refuse("dim[0]", fmt::format("{} dimensions, must be 3", num_dimensions));
    for (int d = 1; d <= num_dimensions; ++d) {
      const int n = whole(40 + 2 * static_cast<std::size_t>(d));
      const std::string field = fmt::format("dim[{}]", d);
      if (d <= 3 && n < 1) refuse(field, fmt::format("{}, must lie in [1, 32767]", n));
      if (d > 3 && n != 1) refuse(field, fmt::format("{} volumes in one file, must be 1", n));
      if (d <= 3) geometry.size[static_cast<std::size_t>(d - 1)] = n;
    }
  }

  /// A slope of 0, or one that is no number, stands for none.
  NumberType read_type() const {
    const double slope = at<float>(112), intercept = at<float>(116);
    if (std::isfinite(slope) && slope != 0 && (slope != 1 || intercept != 0))
      refuse("scl_slope", fmt::format("values are scaled by {:g} and moved by {:g}: labels must be stored as they are",
                                      slope, intercept));
    static const std::map<int, NumberType> kTypes{
        {256, {1, true}},  {2, {1, false}},   {4, {2, true}},     {512, {2, false}},     {8, {4, true}},
        {768, {4, false}}, {1024, {8, true}}, {1280, {8, false}}, {16, {4, true, true}}, {64, {8, true, true}}};
    const auto found = kTypes.find(whole(70));
    if (found == kTypes.end())
      refuse("datatype",
             fmt::format("{}, must be 2, 4, 8, 256, 512, 768, 1024, 1280, 16 or 64: whole numbers of 8 to 64 bits, or "
                         "real ones of 32 or 64",
                         whole(70)));
    NumberType type = found->second;
    if (whole(72) != static_cast<int>(8 * type.bytes))
      refuse("bitpix", fmt::format("{}, must be {} for datatype {}", whole(72), 8 * type.bytes, whole(70)));
    type.swaps_bytes = swaps_bytes_;
    return type;
  }

  /// Returns whether the header says where left, back and head are.
  bool read_axes(VolumeGeometry& geometry) const {
    bool has_frame = true;
    geometry.axes_field = whole(254) > 0 ? "srow_x, srow_y, srow_z" : "pixdim";
    if (whole(254) > 0) {
      for (int row = 0; row < 3; ++row)
        for (int d = 0; d < 4; ++d) {
          const double number = real(280 + 16 * static_cast<std::size_t>(row) + 4 * static_cast<std::size_t>(d),
                                     fmt::format("srow_{}[{}]", "xyz"[row], d));
          (d < 3 ? geometry.axes(row, d) : geometry.origin[row]) = number;
        }
    } else {
      const Vec3 spacing(real(80, "pixdim[1]"), real(84, "pixdim[2]"), real(88, "pixdim[3]"));
      for (int d = 0; d < 3; ++d)
        if (!(spacing[d] > 0))
          refuse(fmt::format("pixdim[{}]", d + 1), fmt::format("{:g}, must be greater than 0", spacing[d]));
      has_frame = whole(252) > 0;
      if (has_frame) {
        geometry.axes = rotation();
        if (real(76, "pixdim[0]") < 0) geometry.axes.col(2) *= -1;
        geometry.origin = Vec3(real(268, "qoffset_x"), real(272, "qoffset_y"), real(276, "qoffset_z"));
      }
      geometry.axes = geometry.axes * spacing.asDiagonal();
    }
    const double scale = millimetres();
    geometry.axes *= scale;
    geometry.origin *= scale;
    if (has_frame) flip(geometry, Vec3(-1, -1, 1));
    return has_frame;
  }

  Mat3 rotation() const {
    const Vec3 vector(real(256, "quatern_b"), real(260, "quatern_c"), real(264, "quatern_d"));
    const double rest = 1 - vector.squaredNorm();
    if (rest < -kMaxExcess)
      refuse("quatern_b, quatern_c, quatern_d",
             fmt::format("the sum of their squares is {:g}, must be at most 1", 1 - rest));
    const Eigen::Quaterniond turn(std::sqrt(std::max(0., rest < kMinScalar ? 0 : rest)), vector[0], vector[1],
                                  vector[2]);
    return turn.normalized().toRotationMatrix();
  }

  double millimetres() const {
    constexpr double kUnits[] = {1, 1000, 1, 1e-3};  // 0 is not said, and by custom mm
    const int unit = header_[123] & 7;
    if (unit > 3) refuse("xyzt_units", fmt::format("{}, must be 0, 1, 2 or 3: not given, m, mm or micrometres", unit));
    return kUnits[unit];
  }

  void skip_extensions() {
    const double offset = real(108, "vox_offset");
    if (offset < kMinOffset || offset > kMaxOffset || offset != std::floor(offset))
      refuse("vox_offset",
             fmt::format("{:.10g}, must be a whole number in [{}, {:.10g}]", offset, kMinOffset, kMaxOffset));
    char skipped[4096];
    for (std::size_t left = static_cast<std::size_t>(offset) - kNiftiHeader; left > 0;) {
      const std::size_t count = std::min(left, sizeof skipped);
      source_.read(skipped, count);
      left -= count;
    }
  }

  static constexpr double kMaxExcess = 1e-5;  // of the squares of single numbers

  std::string name_;
  ByteSource source_;
  bool swaps_bytes_ = false;
  char header_[kNiftiHeader] = {};
};

}  // namespace

ImportedVolume parse_nifti(std::string_view content, const std::string& name, const VoxelCells& planned) {
  return NiftiFile(content, name).read(planned);
}

}  // namespace hexaplast
