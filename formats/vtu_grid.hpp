// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// One array of a .vtu file: how its header describes it, and its bytes, which stay where they are until they are
/// written.
struct VtuArray {
  std::string_view type;  ///< Float64, Int64, Int32 or UInt8
  std::string_view name;
  int components;
  std::span<const std::byte> bytes;
};

template <class Number>
VtuArray scalars(std::string_view type, std::string_view name, const std::vector<Number>& values) {
  return {type, name, 1, std::as_bytes(std::span(values))};
}

VtuArray reals(std::string_view name, int components, std::span<const double> values);
VtuArray vectors(std::string_view name, const PointArray& field);

/// A named number of a whole grid.
struct VtuNumber {
  std::string name;
  std::int32_t value;
};

inline constexpr std::string_view kOfPatient = "LPS";  ///< field data of grids whose coordinates are those of patients

inline constexpr std::uint8_t kVtkVertex = 1, kVtkLine = 3, kVtkTriangle = 5, kVtkQuad = 9, kVtkHexahedron = 12;

/// An unstructured grid of VTK (.vtu), every number with all its bits. Names are escaped where XML demands it.
struct VtuGrid {
  std::span<const double> points;                ///< [m] three per point
  std::span<const std::byte> connectivity = {};  ///< 32-bit point numbers of all cells
  std::vector<std::int64_t> ends = {};           ///< of each cell in the connectivity
  std::vector<std::uint8_t> types = {};          ///< of each cell
  std::vector<VtuArray> point_data = {}, cell_data = {};
  std::vector<VtuNumber> field_data = {};
  std::vector<VtuArray> field_arrays = {};  ///< beside these numbers
  std::string_view shown_first = {};        ///< cell data that programs show at once; empty: none

  void add_cells(std::size_t count, std::uint8_t type, int corners);  ///< cells of one type

  /// As XML with raw appended binary, little-endian, 64-bit headers. Throws OutputError.
  void write(const std::filesystem::path& file) const;

  /// As XML alone: numbers with as many digits as it takes to read them back, in a form that SOFA's MeshVTKLoader reads
  /// too, as long as cell data are not of 8 bits.
  std::string text() const;
};

}  // namespace hexaplast
