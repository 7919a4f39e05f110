// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/readable_file.hpp"
#include "formats/text.hpp"
#include "hexaplast/formats/mesh_import.hpp"

namespace hexaplast {

/// How a file stores numbers.
struct NumberType {
  std::size_t bytes = 1;
  bool is_signed = false, is_real = false;
  bool swaps_bytes = false;  ///< of voxels; a MeshSource has its own
};
inline constexpr NumberType kInt32{4, true}, kInt64{8, true};

/// A number from its bytes, which may have the order of another machine.
template <class T>
T number_at(const char* bytes, bool swaps_bytes) {
  char own[sizeof(T)];
  std::memcpy(own, bytes, sizeof(T));
  if (swaps_bytes) std::reverse(own, own + sizeof(T));
  T number;
  std::memcpy(&number, own, sizeof(T));
  return number;
}

/// The same of a type that is known when the file has been read. Unsigned ones of 64 bits are taken as they are.
template <class Number>
Number number_at(const char* bytes, const NumberType& type, bool swaps_bytes) {
  const auto as = [&]<class T>(T) { return static_cast<Number>(number_at<T>(bytes, swaps_bytes)); };
  if (type.is_real) return type.bytes == 8 ? as(double()) : as(float());
  if (type.bytes == 8) return type.is_signed ? as(std::int64_t()) : as(std::uint64_t());
  if (type.bytes == 4) return type.is_signed ? as(std::int32_t()) : as(std::uint32_t());
  if (type.bytes == 2) return type.is_signed ? as(std::int16_t()) : as(std::uint16_t());
  return type.is_signed ? as(std::int8_t()) : as(std::uint8_t());
}

/// Reads a mesh file from its beginning to its end, and knows where it is.
class MeshSource {
  static constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min(),
                                kMost = std::numeric_limits<std::int64_t>::max();

 public:
  MeshSource(std::string_view content, std::string name) : content_(content), name_(std::move(name)) {}

  [[noreturn]] void refuse(const std::string& what) const;          ///< at the line of the latest word
  [[noreturn]] void refuse_at_byte(const std::string& what) const;  ///< at the present byte, in binary data
  [[noreturn]] void refuse_data(const std::string& what) const;     ///< whichever of the two data are

  std::size_t remaining() const { return content_.size() - at_; }
  bool at_end() const { return at_ == content_.size(); }

  /// The rest of the present line, without its end; the next reading begins with the line after it.
  std::string_view line();

  /// The next word between blanks and line ends; empty at the end of the file.
  std::string_view word();
  void expect(std::string_view wanted);  ///< refuses any other word

  double real(const char* what);
  std::int64_t integer(const char* what, std::int64_t min = kLeast, std::int64_t max = kMost);

  /// A count of things of which each takes at least `bytes` of the rest of the file.
  std::size_t count(const char* what, std::size_t bytes);
  std::size_t checked_count(std::uint64_t number, const char* what, std::size_t bytes, bool is_in_data = true) const;

  /// A whole number of the data: text, or binary of this type.
  std::int64_t number(const NumberType& type, const char* what, std::int64_t min = kLeast, std::int64_t max = kMost);

  /// Goes to the beginning of the line after the next one that is `wanted`, and nothing else.
  void skip_past_line(std::string_view wanted);

  /// A number as bytes. Its bytes are swapped when `swaps_bytes` is set.
  template <class T>
  T binary() {
    return number_at<T>(skip(sizeof(T)), swaps_bytes);
  }
  template <class Number>
  Number binary(const NumberType& type) {
    return number_at<Number>(skip(type.bytes), type, swaps_bytes);
  }
  const char* skip(std::size_t bytes);  ///< of binary data; returns where they begin

  bool is_binary = false;  ///< whether data are
  bool swaps_bytes = false;

 private:
  std::string_view expected_word(std::string_view what);

  std::string_view content_;
  std::string name_;
  std::size_t at_ = 0;
  std::size_t latest_ = 0;  // where the latest word or line began
};

/// A number from the whole of a word; false where the word is none, or does not fit.
bool read_number(std::string_view word, double& number);
bool read_number(std::string_view word, std::int64_t& number);

/// The same for data, which need not be finite: a yield stress may be inf.
bool read_value(std::string_view word, double& number);
inline bool read_value(std::string_view word, std::int64_t& number) { return read_number(word, number); }

std::string in_small_letters(std::string_view text);
std::string_view without_blanks(std::string_view text);  ///< at its ends

/// Points from their coordinates, three each.
PointArray points_of(const std::vector<double>& coordinates);

/// How many nodes a cell of VTK's numbering has; 0: it is none of those below.
std::size_t corners_of_vtk_cell(int kind);

/// Adds a cell of VTK's numbering (3 line, 5 triangle, 8 pixel, 9 quad, 11 voxel, 12 hexahedron), or counts it as
/// skipped. Returns false when it has not as many nodes as its kind.
bool add_vtk_cell(int kind, const std::int64_t* nodes, std::size_t num_nodes, ImportedMesh& mesh);

/// Leaves the first of cells that have the same nodes in the same order, and counts the others. Returns the new number
/// of each hexahedron that there was.
std::vector<int> merge_copies(ImportedMesh& mesh);

/// parse_mesh of each format; parse_vtu is the XML half of parse_vtk.
ImportedMesh parse_gmsh(std::string_view content, const std::string& name);
ImportedMesh parse_vtk(std::string_view content, const std::string& name);
ImportedMesh parse_vtu(std::string_view content, const std::string& name);
ImportedMesh parse_obj(std::string_view content, const std::string& name);
ImportedMesh parse_stl(std::string_view content, const std::string& name);

}  // namespace hexaplast
