// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/conditions_vtu.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <numeric>

#include "formats/vtu_grid.hpp"
#include "hexaplast/base/error.hpp"
#include "record/state_arrays.hpp"

namespace hexaplast::output {
namespace {

constexpr int kTool = -1, kShape = -2;  // in place of a node

}  // namespace

void write_instruments(const std::filesystem::path& file, std::span<const Instrument> instruments,
                       ConstPoints positions) {
  std::size_t num_points = 0;
  for (const Instrument& instrument : instruments)
    num_points += 1 + instrument.nodes.size() + static_cast<std::size_t>(instrument.shape_points.rows());
  PointArray points(static_cast<Eigen::Index>(num_points), 3), force = points;
  std::vector<std::int32_t> ids, nodes, connectivity;

  VtuGrid grid{.points = {points.data(), static_cast<std::size_t>(points.size())}, .shown_first = {}};
  for (const Instrument& instrument : instruments) {
    const auto tool = static_cast<std::int32_t>(ids.size());
    const auto num_held = static_cast<Eigen::Index>(instrument.nodes.size());
    points.row(tool) = instrument.place.transpose();
    force.row(tool) = instrument.force().transpose();
    force.middleRows(tool + 1, num_held) = instrument.forces;
    const auto num_shape = instrument.shape_points.rows();
    ids.insert(ids.end(), 1 + instrument.nodes.size() + static_cast<std::size_t>(num_shape), instrument.id);
    nodes.push_back(kTool);
    connectivity.push_back(tool);
    grid.add_cells(1, kVtkVertex, 1);
    for (const int node : instrument.nodes) {
      const auto point = static_cast<std::int32_t>(nodes.size());
      points.row(point) = positions.row(node);
      nodes.push_back(node);
      connectivity.insert(connectivity.end(), {tool, point});
    }
    grid.add_cells(instrument.nodes.size(), kVtkLine, 2);
    const auto first = static_cast<std::int32_t>(nodes.size());
    points.middleRows(first, num_shape) = instrument.shape_points;
    force.middleRows(first, num_shape).setZero();
    nodes.insert(nodes.end(), static_cast<std::size_t>(num_shape), kShape);
    for (const auto& [a, b, c] : instrument.shape_triangles)
      connectivity.insert(connectivity.end(), {first + a, first + b, first + c});
    grid.add_cells(instrument.shape_triangles.size(), kVtkTriangle, 3);
  }
  grid.connectivity = std::as_bytes(std::span(connectivity));
  grid.point_data = {scalars("Int32", "id", ids), scalars("Int32", "node", nodes), vectors("force", force)};
  grid.write(file);
}

std::vector<Instrument> read_instruments(const std::filesystem::path& file) {
  const ImportedState state = read_vtu_state(file);
  const std::vector<int> ids = point_numbers(file, state, "id"), nodes = point_numbers(file, state, "node");
  const PointArray force = point_vectors(file, state, "force");
  std::vector<Instrument> instruments;
  auto triangle = state.mesh.triangles.begin();
  const auto refuse = [&](std::size_t point) {
    throw InputError(fmt::format("{}: point {} is neither a tool, nor held by the one before, nor of its surface",
                                 file.string(), point));
  };
  for (std::size_t tool = 0, end = 0; tool < nodes.size(); tool = end) {
    if (nodes[tool] != kTool) refuse(tool);
    Instrument& instrument = instruments.emplace_back();
    instrument.id = ids[tool];
    instrument.place = state.mesh.positions.row(static_cast<Eigen::Index>(tool)).transpose();
    for (end = tool + 1; end < nodes.size() && nodes[end] >= 0; ++end) {
      if (ids[end] != instrument.id) refuse(end);
      instrument.nodes.push_back(nodes[end]);
    }
    instrument.forces =
        force.middleRows(static_cast<Eigen::Index>(tool + 1), static_cast<Eigen::Index>(instrument.nodes.size()));
    const auto shape = static_cast<int>(end);
    for (; end < nodes.size() && nodes[end] != kTool; ++end)
      if (nodes[end] != kShape || ids[end] != instrument.id) refuse(end);
    instrument.shape_points = state.mesh.positions.middleRows(shape, static_cast<Eigen::Index>(end) - shape);
    for (; triangle != state.mesh.triangles.end() && (*triangle)[0] < static_cast<int>(end); ++triangle) {
      for (const int corner : *triangle)
        if (corner < shape || corner >= static_cast<int>(end))
          throw InputError(fmt::format("{}: a triangle has point {}, which is not of the surface of instrument {}",
                                       file.string(), corner, instrument.id));
      instrument.shape_triangles.push_back({(*triangle)[0] - shape, (*triangle)[1] - shape, (*triangle)[2] - shape});
    }
  }
  if (triangle != state.mesh.triangles.end())
    throw InputError(fmt::format("{}: a triangle is of no instrument's surface", file.string()));
  return instruments;
}

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
