// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>

#include "picture/bodies.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/regions.hpp"

namespace hexaplast::output {

inline constexpr std::string_view kRegionPrefix = "region ";  ///< of the field data that name regions

inline constexpr std::string_view kInitialNode = "initial_node", kCrossing = "crossing", kRemoved = "removed";
inline constexpr int kNumbersOfRemoved = 1 + kCorners + 6;

/// Writes one state of bodies as a VTK unstructured grid of hexahedra (formats/vtu_grid.hpp). The points are the
/// current positions [m].
///
///   point data: displacement [m], plastic_rest_position [m], velocity [m/s], and as far as they are given fixed (0 or
///   1)
///               and load [N] (BoundaryConditions)
///   cell data:  id, part, of several bodies also body, stress_norm [Pa], plastic_strain [-], yield_stress [Pa],
///               volume_ratio [-], strain [-] (ElementFields), and region where regions are given: the number of the
///               hexahedron's region
///               and where nodes are split, crossing [-]: one per side of the hexahedron (OpenFaces, kFaces)
///   field data: `region NAME` for each region: its number; and where nodes are split, removed: per removed hexahedron
///               its id, points and crossings
///
/// Cells are the hexahedra that are left; points are all nodes, also those that have lost their last hexahedron. `id`
/// is a cell's number in the mesh that the run began with: it stays the same, whatever has gone. `part` numbers the
/// connected pieces of this state, in the order of their first nodes, and `body` the bodies (Bodies::all). yield_stress
/// is infinite where a hexahedron never yields. fields: those of the body at the positions. Throws OutputError.
void write_vtu(const std::filesystem::path& file, const Bodies& bodies, ConstPoints positions, ConstPoints velocities,
               ElementFields fields, const BoundaryConditions& conditions = {}, const Regions& regions = {});

}  // namespace hexaplast::output
