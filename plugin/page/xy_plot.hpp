// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hexaplast/formats/whole_file.hpp"

namespace hexaplast::output {

/// Points, or a line through them, in the order given.
struct XYCurve {
  std::string name;  ///< in the legend
  std::string colour;
  std::vector<double> x;
  std::vector<double> y;  ///< as many; where one is not finite there is a gap
  bool has_line = true;
  bool has_dots = true;
};

struct XYPanel {
  std::string title = {};  ///< may be empty
  std::vector<XYCurve> curves = {};
};

/// What stands along the horizontal axis.
struct XAxis {
  std::string label;
  bool is_logarithmic = false;          ///< all values > 0
  std::vector<std::string> names = {};  ///< not numbers but these, at 0, 1, 2, ...
};

/// Small plots of one quantity, side by side, with the same axes, so that they can be compared.
struct XYGrid {
  std::string quantity;   ///< with its unit
  double least_span = 1;  ///< smaller ranges are shown this large, so that rounding does not look like a result
  XAxis across;
  std::vector<XYPanel> panels;  ///< at least one
};

/// Writes the grids, one below the other, as one SVG picture. Curves of the same name and colour stand in the legend
/// once. Throws OutputError.
void write_xy_plot(WholeFile& file, const std::string& title, std::span<const XYGrid> grids);
void write_xy_plot(const std::filesystem::path& file, const std::string& title, std::span<const XYGrid> grids);

}  // namespace hexaplast::output
