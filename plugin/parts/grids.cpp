// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/grids.hpp"

#include <fmt/format.h>

#include <array>
#include <numbers>

#include "attributes/shapes.hpp"
#include "base/memory.hpp"
#include "hexaplast/geometry/shapes.hpp"
#include "parts/option.hpp"

namespace hexaplast::parts {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMaxCells = 16'777'216;

/// What was checked before, and cells: throws all that is wrong.
std::array<int, 3> three_cells(OptionRanges& ranges, const std::vector<int>& cells) {
  ranges.collect([&] {
    if (cells.size() != 3) throw OptionError("cells", fmt::format("{} numbers given, must be three", cells.size()));
    check_num_hexahedra("cells", static_cast<double>(cells[0]) * cells[1] * cells[2]);
  });
  ranges.throw_all();
  return {cells[0], cells[1], cells[2]};
}

}  // namespace

HexMesh make_grid(const TubeGridOptions& options) {
  OptionRanges ranges(attributes::kTubeGridTopology, options);
  const std::array<int, 3> cells = three_cells(ranges, options.cells);
  const int num_points = cells[2] + 1;
  const Centreline curve = options.centreline ? curve_through(*options.centreline, num_points)
                                              : arc(options.length, options.bend * kDegree, num_points);
  return tube(cells, options.inner_radius, options.outer_radius, curve);
}

HexMesh make_grid(const SheetGridOptions& options) {
  OptionRanges ranges(attributes::kSheetGridTopology, options);
  if (options.size.size() != 2) ranges.add({"size", fmt::format("{} numbers given, must be two", options.size.size())});
  const std::array<int, 3> cells = three_cells(ranges, options.cells);
  return sheet(cells, {options.size[0], options.size[1]}, options.thickness, options.curvature);
}

HexMesh make_grid(const SpherePatchGridOptions& options) {
  OptionRanges ranges(attributes::kSpherePatchGridTopology, options);
  const std::array<int, 3> cells = three_cells(ranges, options.cells);
  return sphere_patch(cells, options.inner_radius, options.outer_radius, options.angle * kDegree);
}

void check_num_cells(std::string_view option, double num_cells) {
  if (num_cells > kMaxCells)
    throw OptionError(option, fmt::format("{:.4g} cells, must be at most {:.10g}", num_cells, kMaxCells));
}

void check_num_hexahedra(std::string_view option, double num_hexahedra) {
  check_num_cells(option, num_hexahedra);
  try {
    require_memory(num_hexahedra);
  } catch (const InputError& error) {
    throw OptionError(option, error.what());
  }
}

}  // namespace hexaplast::parts
