// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hexaplast::runner {

/// What can be measured on a specimen and on a body alike; kProbe: what a Probe of the scene records.
enum class Quantity { kElongation, kPlasticElongation, kTwist, kPlasticTwist, kForce, kProbe };

struct QuantityEntry {
  Quantity quantity;
  std::string_view column;  ///< of the file
  std::string_view unit;    ///< empty: a fraction
  std::string_view label;   ///< in pictures
  double shown_scale;       ///< from the column's unit to the label's
};

/// elongation (or world_elongation), plastic_elongation, twist_deg (or world_twist_deg), plastic_twist_deg, force.
std::span<const QuantityEntry> quantities();

/// A measured curve: over time where the file has that column, otherwise over force.
struct TargetCurve {
  struct Column {
    Quantity quantity;
    std::string name, unit;      ///< of a probe the unit is not known here
    std::string label;           ///< in pictures
    double shown_scale = 1;      ///< from the unit to the label's
    std::vector<double> values;  ///< per row
  };
  std::filesystem::path file;
  int head_line;                ///< of the file: that of the names
  std::vector<int> lines;       ///< of the file, per row
  std::vector<double> times;    ///< [s] ascending; empty: the curve is over force
  std::vector<double> forces;   ///< [N] in the order of the experiment; empty: the curve is over time
  std::vector<Column> columns;  ///< that are compared; at least one

  std::size_t num_rows() const { return lines.size(); }
};

/// Reads a CSV file: a line of column names, then rows of numbers; empty lines and those that begin with # are passed
/// over. `compare` names the columns that are compared; empty: all but the first of time and force that the file has.
/// Names that are none of quantities() are taken for those of probes, also as columns of history.csv have them. Throws
/// FileError where the file cannot be read, and SceneError with file and line.
TargetCurve read_target(const std::filesystem::path& file, const std::vector<std::string>& compare);

}  // namespace hexaplast::runner
