// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/springs_vtu.hpp"

#include <fmt/format.h>

#include <numeric>

#include "formats/vtu_grid.hpp"
#include "hexaplast/base/error.hpp"
#include "record/state_arrays.hpp"

namespace hexaplast::output {

void write_springs(const std::filesystem::path& file, std::span<const SpringLine> springs) {
  PointArray points(2 * static_cast<Eigen::Index>(springs.size()), 3);
  std::vector<std::int32_t> slack, connectivity(2 * springs.size());
  std::iota(connectivity.begin(), connectivity.end(), 0);
  for (const auto& [from, to, is_slack] : springs) {
    const auto first = static_cast<Eigen::Index>(slack.size());
    points.row(first) = from.transpose();
    points.row(first + 1) = to.transpose();
    slack.insert(slack.end(), 2, is_slack ? 1 : 0);
  }
  VtuGrid grid{.points = {points.data(), static_cast<std::size_t>(points.size())}, .shown_first = {}};
  grid.add_cells(springs.size(), kVtkLine, 2);
  grid.connectivity = std::as_bytes(std::span(connectivity));
  grid.point_data = {scalars("Int32", "slack", slack)};
  grid.write(file);
}

std::vector<SpringLine> read_springs(const std::filesystem::path& file) {
  const ImportedState state = read_vtu_state(file);
  const std::vector<int> slack = point_numbers(file, state, "slack");
  const PointArray& points = state.mesh.positions;
  std::vector<SpringLine> springs;
  for (const auto& [a, b] : state.mesh.edges)
    springs.push_back({points.row(a).transpose(), points.row(b).transpose(), slack[static_cast<std::size_t>(a)] != 0});
  if (!points.allFinite()) throw InputError(fmt::format("{}: points must be finite numbers", file.string()));
  return springs;
}

}  // namespace hexaplast::output
