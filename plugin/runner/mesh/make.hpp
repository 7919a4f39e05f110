// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

namespace hexaplast::runner {

/// `hexaplast mesh grid`, `sheet`, `tube` and `sphere-patch`, as the command line gives them. Lengths in m.
struct MeshGridOptions {
  std::array<int, 3> cells{};
  std::array<double, 3> size{};
  std::array<double, 3> origin{};  ///< the lower corner
  std::filesystem::path out;
};
struct MeshSheetOptions {
  std::array<int, 3> cells{};
  std::array<double, 2> size{};
  double thickness = 0;
  double curvature = 0;  ///< [1/m]
  std::filesystem::path out;
};
struct MeshTubeOptions {
  std::array<int, 3> cells{};  ///< outward, around, along
  double inner = 0, outer = 0;
  std::optional<double> length;
  double bend = 0;                             ///< [deg]
  std::optional<std::filesystem::path> along;  ///< its vertices are points of the centreline
  std::filesystem::path out;
};
struct MeshSpherePatchOptions {
  std::array<int, 3> cells{};
  double inner = 0, outer = 0;
  double angle = 90;  ///< [deg]
  std::filesystem::path out;
};

/// `hexaplast mesh offset`, as the command line gives it.
struct MeshOffsetOptions {
  std::filesystem::path surface;
  double thickness = 0;  ///< [m]
  int layers = 1;
  std::string direction = "outward";  ///< inward, outward, or both: half to either side
  std::filesystem::path out;
};

/// Each writes hexahedra (.vtu or .msh) and prints what they are. Throw what the modules below throw.
void make_grid(const MeshGridOptions& options);
void make_sheet(const MeshSheetOptions& options);
void make_tube(const MeshTubeOptions& options);
void make_sphere_patch(const MeshSpherePatchOptions& options);
void make_shell(const MeshOffsetOptions& options);

}  // namespace hexaplast::runner
