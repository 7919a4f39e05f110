// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "picture/boundary_conditions.hpp"

namespace hexaplast::output {

/// Writes springs as a VTK unstructured grid (formats/vtu_grid.hpp): a line with two points of its own for each.
///
///   point data: slack (1 where the spring is shorter than at rest)
///
/// Throws OutputError.
void write_springs(const std::filesystem::path& file, std::span<const SpringLine> springs);

/// What was written so. Throws InputError.
std::vector<SpringLine> read_springs(const std::filesystem::path& file);

}  // namespace hexaplast::output
