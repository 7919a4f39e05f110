// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device/device_levels.hpp"

#include <utility>

#include "mesh/trilinear.hpp"

namespace hexaplast {

namespace {

/// The nodes of a mesh: numbers of slots and of the device.
struct Numbers {
  Numbers(const Partition& partition, const BrickLayout& layout) {
    of_slot.resize(partition.num_nodes);
    for (int n = 0; n < layout.num_nodes(); ++n) {
      slot.push_back(partition.slot_of_node[layout.node_of[n]]);
      of_slot[slot.back()] = n;
    }
  }
  std::vector<int> slot, of_slot;
};

NodalMap on_device(const NodalMap& by_slots, const Numbers& rows, const Numbers& columns) {
  NodalMap map;
  map.first.push_back(0);
  for (const int row : rows.slot) {
    for (int k = by_slots.first[row]; k < by_slots.first[row + 1]; ++k) {
      map.column.push_back(columns.of_slot[by_slots.column[k]]);
      map.weight.push_back(by_slots.weight[k]);
    }
    map.first.push_back(static_cast<int>(map.column.size()));
  }
  return map;
}

MapArrays arrays_of(const NodalMap& map) {
  return {map.num_rows(), map.first.data(), map.column.data(), map.weight.data()};
}

}  // namespace

DeviceLevels::DeviceLevels(const Model& model, const History& history, const Bricks& finest) {
  const double of_length = 1 / (model.length * model.length);
  std::vector<Lame> stiffness(model.mesh.num_elements());  // of the finer mesh, times volume / length^2
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    if (history.alive[e])
      stiffness[e] = {of_length * model.volume[e] * model.lame[e].mu,
                      of_length * model.volume[e] * model.lame[e].lambda};
  const BrickLayout* finer = &finest;
  Numbers of_finer(*model.partition, finest);
  auto finer_points = slot_vector<double>(*model.partition);
  to_slots(*model.partition, model.mesh.positions(), finer_points);
  levels_.reserve(model.coarse_meshes().size());
  for (const CoarseMesh& mesh : model.coarse_meshes()) {
    const Partition& partition = *mesh.partition;
    auto points = slot_vector<double>(partition);
    mesh.place(finer_points, points);
    PointArray nodes(partition.num_nodes, 3);
    for (int n = 0; n < partition.num_nodes; ++n)
      for (int i = 0; i < 3; ++i) nodes(n, i) = points[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i];

    Level& level = levels_.emplace_back();
    level.at = BrickLayout(mesh.cells, nodes, [](int) { return true; });
    level.rest.resize(9 * level.at.element.size());
    level.moduli.resize(2 * kCorners * level.at.element.size());
    level.child.resize(kCorners * level.at.element.size());
    std::vector<Lame> of_cells(mesh.cells.size());
    for (int place = 0; place < level.at.num_places(); ++place) {
      const int cell = level.at.like(place);
      const bool is_there = level.at.element[place] >= 0;
      const auto set = [place](std::vector<float>& to, int count, int k, double number) {
        to[BrickLayout::index(place, count, k)] = static_cast<float>(number);
      };
      const Mat3 edges = 2 * centre_jacobian(gather(nodes, mesh.cells[cell]));
      // corners beyond the mesh may lie anywhere: cells that they invert do not help
      const bool is_sound = edges.determinant() > 0;
      const Mat3 inverse = is_sound ? Mat3(model.length * edges.inverse()) : Mat3(Mat3::Identity());
      for (int k = 0; k < 9; ++k) set(level.rest, 9, k, inverse(k / 3, k % 3));
      for (int i = 0; i < kCorners; ++i) {
        const int child = mesh.children[cell][i];
        const Lame of_child = child >= 0 && is_sound ? stiffness[child] : Lame{};
        level.child[BrickLayout::index(place, kCorners, i)] = child < 0 ? -1 : finer->place_of[child];
        set(level.moduli, 2 * kCorners, 2 * i, of_child.mu);
        set(level.moduli, 2 * kCorners, 2 * i + 1, of_child.lambda);
        if (!is_there) continue;
        of_cells[cell].mu += of_child.mu;
        of_cells[cell].lambda += of_child.lambda;
      }
    }

    Numbers own(partition, level.at);
    level.placement = on_device(mesh.placement, own, of_finer);
    level.restriction = on_device(mesh.restriction, own, of_finer);
    level.prolongation = on_device(mesh.prolongation, of_finer, own);
    for (const int slot : own.slot) {
      const int there = mesh.finer_slot[slot];
      level.fine_node.push_back(there < 0 ? -1 : of_finer.of_slot[there]);
    }
    finer = &level.at;
    of_finer = std::move(own);
    finer_points = std::move(points);
    stiffness = std::move(of_cells);
  }
}

std::vector<LevelArrays> DeviceLevels::arrays() const {
  std::vector<LevelArrays> all;
  for (const Level& level : levels_)
    all.push_back({.at = level.at.arrays(),
                   .rest = level.rest.data(),
                   .moduli = level.moduli.data(),
                   .child = level.child.data(),
                   .fine_node = level.fine_node.data(),
                   .placement = arrays_of(level.placement),
                   .restriction = arrays_of(level.restriction),
                   .prolongation = arrays_of(level.prolongation)});
  return all;
}

}  // namespace hexaplast
