// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hexaplast/formats/whole_file.hpp"
#include "page/chart.hpp"

namespace hexaplast::output {

/// Small panels of one quantity, side by side, with the same axes (those of axes_of), so that they can be compared.
struct PanelGrid {
  std::string quantity;       ///< with its unit
  std::vector<Panel> panels;  ///< at least one; each with what tells it from the others in place of the quantity
};

/// Writes the grids, one below the other, as one SVG picture. Curves of the same name and colour stand in the legend
/// once. Throws OutputError.
void write_panel_grids(WholeFile& file, const std::string& title, std::span<const PanelGrid> grids);
void write_panel_grids(const std::filesystem::path& file, const std::string& title, std::span<const PanelGrid> grids);

}  // namespace hexaplast::output
