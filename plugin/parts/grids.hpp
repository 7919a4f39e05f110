// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "hexaplast/mesh/hex_mesh.hpp"
#include "parts/option.hpp"

/// Grids bent into the shapes of organs (hexaplast/geometry/shapes.hpp), with the options that scenes give. All throw
/// OptionError, and InputError for shapes that fold or run into themselves.
namespace hexaplast::parts {

/// In scenes: TubeGridTopology.
struct TubeGridOptions {
  std::vector<int> cells = {2, 16, 20};  ///< hexahedra outward, around (at least 3) and along
  double inner_radius = 0.01;            ///< [m]
  double outer_radius = 0.012;           ///< [m]
  double length = 0.1;                   ///< [m] from the origin along z, where there is no centreline
  double bend = 0;                       ///< [deg] by which it is bent towards x, where there is no centreline
  std::optional<PointArray> centreline = std::nullopt;  ///< [m] points of a smooth curve to follow instead

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(cells);
    HEXAPLAST_OPTION(inner_radius);
    HEXAPLAST_OPTION(outer_radius);
    HEXAPLAST_OPTION(length);
    HEXAPLAST_OPTION(bend);
    HEXAPLAST_OPTION(centreline);
  }
};
HexMesh make_grid(const TubeGridOptions& options);

/// In scenes: SheetGridTopology.
struct SheetGridOptions {
  std::vector<int> cells = {16, 16, 2};   ///< hexahedra along x, along y and across
  std::vector<double> size = {0.1, 0.1};  ///< [m] along x and y, in the middle of the thickness
  double thickness = 0.002;               ///< [m] along z
  double curvature = 0;                   ///< [1/m] about an axis along y

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(cells);
    HEXAPLAST_OPTION(size);
    HEXAPLAST_OPTION(thickness);
    HEXAPLAST_OPTION(curvature);
  }
};
HexMesh make_grid(const SheetGridOptions& options);

/// In scenes: SpherePatchGridTopology.
struct SpherePatchGridOptions {
  std::vector<int> cells = {16, 16, 2};  ///< hexahedra along x, along y and outward
  double inner_radius = 0.01;            ///< [m]
  double outer_radius = 0.012;           ///< [m]
  double angle = 90;                     ///< [deg] from side to side

  static void each(auto& options, const auto& visit) {
    HEXAPLAST_OPTION(cells);
    HEXAPLAST_OPTION(inner_radius);
    HEXAPLAST_OPTION(outer_radius);
    HEXAPLAST_OPTION(angle);
  }
};
HexMesh make_grid(const SpherePatchGridOptions& options);

/// Throws OptionError for more cells than a topology may have.
void check_num_cells(std::string_view option, double num_cells);

/// The same, and for hexahedra whose body does not fit into the machine's memory; before they are made.
void check_num_hexahedra(std::string_view option, double num_hexahedra);

}  // namespace hexaplast::parts
