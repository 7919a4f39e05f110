// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "picture/boundary_conditions.hpp"

namespace hexaplast::output {

/// Writes instruments as a VTK unstructured grid (formats/vtu_grid.hpp): for each of them a vertex where the tool is, a
/// line from there to each node that it acts on, and the triangles of its surface if it has a shape. positions:
/// num_nodes x 3 [m].
///
///   point data: id (of the instrument), node (-1 for the tool, -2 for its surface), force [N] (on a node; at the tool
///   that on all)
///
/// Throws OutputError.
void write_instruments(const std::filesystem::path& file, std::span<const Instrument> instruments,
                       ConstPoints positions);

/// What was written so. Throws InputError.
std::vector<Instrument> read_instruments(const std::filesystem::path& file);

/// Writes springs as a VTK unstructured grid (formats/vtu_grid.hpp): a line with two points of its own for each.
///
///   point data: slack (1 where the spring is shorter than at rest)
///
/// Throws OutputError.
void write_springs(const std::filesystem::path& file, std::span<const SpringLine> springs);

/// What was written so. Throws InputError.
std::vector<SpringLine> read_springs(const std::filesystem::path& file);

}  // namespace hexaplast::output
