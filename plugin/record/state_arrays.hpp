// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "hexaplast/formats/mesh_import.hpp"

namespace hexaplast::output {

/// Arrays of a .vtu file that has been read. Each of these throws InputError, which names the file, where the array is
/// missing or has another shape.
PointArray point_vectors(const std::filesystem::path& file, const ImportedState& state, std::string_view name);
std::vector<int> point_numbers(const std::filesystem::path& file, const ImportedState& state, std::string_view name);
std::vector<double> cell_scalars(const std::filesystem::path& file, const ImportedState& state, std::string_view name);

/// Per cell, as many numbers as its array has components.
std::vector<double> cell_numbers(const std::filesystem::path& file, const ImportedState& state, std::string_view name,
                                 int num_components);

/// Per row, as many numbers as an array of the grid as a whole has components; empty where there is none.
std::vector<double> field_numbers(const std::filesystem::path& file, const ImportedState& state, std::string_view name,
                                  int num_components);

bool has_cell_data(const ImportedState& state, std::string_view name);
bool has_point_data(const ImportedState& state, std::string_view name);

}  // namespace hexaplast::output
