// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "hexaplast/body.hpp"

namespace hexaplast::output {

/// Writes one state of a body as a VTK unstructured grid of hexahedra (XML, raw appended binary, little-endian, 64-bit
/// headers). The points are the world positions [m]; every number is written with all its bits.
///
///   point data: displacement [m], material_position [m], velocity [m/s]
///   cell data:  id, part, stress_norm [Pa], plastic_strain [-], yield_stress [Pa], volume_ratio [-], strain [-]
///               (ElementFields)
///
/// Cells are the hexahedra that are left; points are all nodes, also those that have lost their last hexahedron. `id`
/// is a cell's number in the mesh that the run began with: it stays the same, whatever has gone. `part` numbers the
/// connected pieces of this state, in the order of their first nodes. yield_stress is infinite where a hexahedron never
/// yields.
/// Throws OutputError.
void write_vtu(const std::filesystem::path& file, const Body& body, ConstPoints positions, ConstPoints velocities);

/// The time series of a run: names of .vtu files beside it and their times.
class TimeSeries {
 public:
  explicit TimeSeries(std::filesystem::path file) : file_(std::move(file)) {}

  /// Adds a state and replaces the file; `vtu` must be complete on disk. Throws OutputError; the file is then as
  /// before.
  void add(double time, const std::string& vtu);

  /// Names and times, into a checkpoint or from one.
  void serialize(Archive& archive);

  /// Leaves out those entries that are not wanted, and replaces the file. Throws OutputError.
  void keep(const std::function<bool(const std::string& vtu)>& is_wanted);
  bool has(const std::string& vtu) const;

 private:
  struct Entry {
    double time = 0;  // [s]
    std::string vtu;
  };
  void write(const std::vector<Entry>& entries) const;

  std::filesystem::path file_;
  std::vector<Entry> entries_;
};

}  // namespace hexaplast::output
