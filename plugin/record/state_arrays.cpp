// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/state_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hexaplast/base/error.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

/// One row per point or cell, transposed.
Eigen::Map<const Eigen::MatrixXd> rows_of(const fs::path& file, const char* kind,
                                          const std::vector<ImportedArray>& arrays, std::string_view name,
                                          int num_components, Eigen::Index count) {
  const auto found = std::ranges::find(arrays, name, &ImportedArray::name);
  if (found == arrays.end()) {
    std::string others;
    for (const ImportedArray& other : arrays) others += (others.empty() ? "" : ", ") + other.name;
    throw InputError(fmt::format("{}: holds no array '{}' of {}; it holds: {}", file.string(), name, kind,
                                 others.empty() ? "none" : others));
  }
  if (found->num_components != num_components ||
      static_cast<Eigen::Index>(found->values.size()) != num_components * count)
    throw InputError(fmt::format("{}: array '{}' has {} components for {} {}, must have {} for {}", file.string(), name,
                                 found->num_components, found->values.size() / found->num_components, kind,
                                 num_components, count));
  return {found->values.data(), num_components, count};
}

}  // namespace

PointArray point_vectors(const fs::path& file, const ImportedState& state, std::string_view name) {
  return rows_of(file, "points", state.point_data, name, 3, state.mesh.positions.rows()).transpose();
}

std::vector<int> point_numbers(const fs::path& file, const ImportedState& state, std::string_view name) {
  const auto values = rows_of(file, "points", state.point_data, name, 1, state.mesh.positions.rows());
  const auto is_whole = [](double value) {
    return value == std::floor(value) && std::abs(value) <= std::numeric_limits<int>::max();
  };
  if (!std::ranges::all_of(values.reshaped(), is_whole))
    throw InputError(fmt::format("{}: array '{}' of points must hold whole numbers of 32 bits", file.string(), name));
  return {values.data(), values.data() + values.size()};
}

std::vector<double> cell_scalars(const fs::path& file, const ImportedState& state, std::string_view name) {
  return cell_numbers(file, state, name, 1);
}

std::vector<double> cell_numbers(const fs::path& file, const ImportedState& state, std::string_view name,
                                 int num_components) {
  const auto values = rows_of(file, "cells", state.cell_data, name, num_components,
                              static_cast<Eigen::Index>(state.mesh.hexahedra.size()));
  return {values.data(), values.data() + values.size()};
}

std::vector<double> field_numbers(const fs::path& file, const ImportedState& state, std::string_view name,
                                  int num_components) {
  const auto found = std::ranges::find(state.field_data, name, &ImportedArray::name);
  if (found == state.field_data.end()) return {};
  const auto values = rows_of(file, "the whole", state.field_data, name, num_components,
                              std::ssize(found->values) / found->num_components);
  return {values.data(), values.data() + values.size()};
}

bool has_cell_data(const ImportedState& state, std::string_view name) {
  return std::ranges::find(state.cell_data, name, &ImportedArray::name) != state.cell_data.end();
}

bool has_point_data(const ImportedState& state, std::string_view name) {
  return std::ranges::find(state.point_data, name, &ImportedArray::name) != state.point_data.end();
}

}  // namespace hexaplast::output
