// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <zlib.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/formats/volume_import.hpp"
#include "mesh_source.hpp"

namespace hexaplast {

/// Bytes of a file, as they are or unpacked while they are read (gzip and zlib).
class ByteSource {
 public:
  ByteSource(std::string_view content, bool is_compressed, std::string name);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Refuses data that cannot be that many bytes.
  void require_room_for(double bytes) const;
  void read(char* to, std::size_t bytes);  ///< refuses data that end before
  void expect_end();                       ///< refuses data that go on, or whose checksum is wrong

 private:
  [[noreturn]] void refuse(const std::string& what) const;
  std::size_t read_some(char* to, std::size_t bytes);  // less where the data end

  std::string_view content_;
  std::string name_;
  bool is_compressed_, is_at_end_ = false;
  std::size_t num_read_ = 0;  // bytes given so far
  std::size_t num_left_ = 0;  // bytes that zlib has not been told of
  z_stream stream_{};
};

bool is_gzip(std::string_view content);

/// Size, axes and origin of a volume, as a header describes them [mm].
struct VolumeGeometry {
  std::array<std::int64_t, 3> size{};
  std::string axes_field;  ///< which field of the header gives the axes
  Mat3 axes = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
};

/// The volume of a header with all voxels, behind which the data must end.
LabelledVolume read_voxels(const VolumeGeometry& geometry, const NumberType& type, ByteSource& source,
                           const std::string& name, const VoxelCells& planned);

/// Changes coordinates to LPS: some of x, y and z change their sign.
void flip(VolumeGeometry& geometry, const Vec3& signs);

/// The text at the beginning of a file, and its fields, each with its line.
class TextHeader {
 public:
  TextHeader(std::string_view content, std::string name);

  bool next_line(std::string_view& text);  ///< false at the end of the file; refuses a header that is too long
  std::string_view rest() const;           ///< what is behind the present line

  /// A field of the present line, which may be named in any case. Refuses one that is there already.
  void add(std::string_view field, std::string_view value);

  const std::string* find(const std::string& field) const;          ///< null: it is not there
  const std::string& value(const std::string& field) const;         ///< refuses a header without it
  void expect(const std::string& field, const char* wanted) const;  ///< refuses any other value, if it is there
  std::vector<std::string_view> words(const std::string& field) const;
  std::vector<double> reals(const std::string& field, std::size_t count) const;
  std::array<std::int64_t, 3> size(const std::string& field) const;  ///< three whole numbers from 1
  Vec3 spacing(const std::string& field) const;                      ///< three numbers greater than 0
  template <class Meaning>
  Meaning one_of(const std::string& field, const std::map<std::string, Meaning>& known) const;

  /// "FILE:LINE: field 'value': what"
  [[noreturn]] void refuse(const std::string& field, const std::string& what) const;
  [[noreturn]] void refuse_line(const std::string& what) const;  ///< the present one

  /// The data of a header that names a file beside it.
  std::string data_beside(const std::string& field, const ReadBeside& beside) const;

 private:
  struct Value {
    std::string text;
    long line;
  };
  [[noreturn]] void refuse_word(const std::string& field, const std::vector<std::string>& known) const;

  std::string_view content_;
  std::string name_;
  MeshSource lines_;
  long line_ = 0;
  std::map<std::string, Value> values_;  // by the name in small letters
};

template <class Meaning>
Meaning TextHeader::one_of(const std::string& field, const std::map<std::string, Meaning>& known) const {
  const auto found = known.find(in_small_letters(value(field)));
  if (found != known.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, meaning] : known) names.push_back(name);
  refuse_word(field, names);
}

}  // namespace hexaplast
