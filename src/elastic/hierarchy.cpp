// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/elastic/hierarchy.hpp"

#include <type_traits>

#include "elastic/element_pass.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

namespace {

constexpr int kFewestNodes = 30;  // of the coarsest mesh

/// Rows and columns of a nodal map by slots instead of nodes.
NodalMap by_slots(const NodalMap& map, const Partition& rows, const Partition& columns) {
  NodalMap out;
  out.first.assign(1, 0);
  for (int slot = 0; slot < rows.num_nodes; ++slot) {
    const int row = rows.node_of_slot[slot];
    for (int k = map.first[row]; k < map.first[row + 1]; ++k) {
      out.column.push_back(columns.slot_of_node[map.column[k]]);
      out.weight.push_back(map.weight[k]);
    }
    out.first.push_back(static_cast<int>(out.column.size()));
  }
  return out;
}

/// to = map from, copies included.
void place(const NodalMap& map, const Partition& partition, const AlignedVector<double>& from,
           AlignedVector<double>& to) {
  parallel_for(partition.num_nodes, [&](int slot) {
    double at[3] = {0, 0, 0};
    for (int k = map.first[slot]; k < map.first[slot + 1]; ++k)
      for (int i = 0; i < 3; ++i)
        at[i] += static_cast<double>(map.weight[k]) * from[4 * static_cast<std::size_t>(map.column[k]) + i];
    for (int i = 0; i < 3; ++i) to[4 * static_cast<std::size_t>(slot) + i] = at[i];
  });
  parallel_for(partition.num_chunks, [&](int chunk) { update_copies(partition, chunk, to.data()); });
}

/// Weights of the samples: what the children weigh in all.
template <class Finer>
void gather_weights(const std::vector<std::array<int, kCorners>>& children, const Finer& finer,
                    ElementOperator<float, float>& op) {
  const std::vector<int>&fine_place = finer.partition().place_of_element, &place = op.partition().place_of_element;
  const int samples = finer.per_sample ? kCorners : 1;
  const float each = finer.per_sample ? 1.0f : static_cast<float>(kCorners);
  parallel_for(static_cast<int>(children.size()), [&](int cell) {
    for (int i = 0; i < kCorners; ++i)
      for (int which = 0; which < 2; ++which) {
        const int child = children[cell][i];
        float sum = 0;
        for (int s = 0; child >= 0 && s < samples; ++s) {
          const std::size_t at = (static_cast<std::size_t>(fine_place[child] / kBlock) * samples + s) * 2 + which;
          sum += each * static_cast<float>(finer.weight[at * kBlock + fine_place[child] % kBlock]);
        }
        const std::size_t at = (static_cast<std::size_t>(place[cell] / kBlock) * kCorners + i) * 2 + which;
        op.weight[at * kBlock + place[cell] % kBlock] = sum;
      }
  });
}

}  // namespace

ElementHierarchy::Level::Level(const Coarsening& coarsening, const Partition& finer)
    : partition(std::make_shared<const Partition>(coarsening.num_nodes, coarsening.cells)),
      children(coarsening.children),
      prolongation(by_slots(coarsening.prolongation, finer, *partition)),
      restriction(prolongation.transposed(coarsening.num_nodes)),
      placement(by_slots(coarsening.placement, *partition, finer)),
      material(slot_vector<double>(*partition)),
      world(slot_vector<double>(*partition)),
      op(partition) {
  for (int slot = 0; slot < partition->num_nodes; ++slot) {
    const int fine = coarsening.fine_node[partition->node_of_slot[slot]];
    finer_slot.push_back(fine < 0 ? -1 : finer.slot_of_node[fine]);
  }
  op.per_sample = true;
  op.resize(std::vector<unsigned char>(partition->num_blocks, 1));
  std::fill(op.weight.begin(), op.weight.end(), 0.0f);  // of cells that are not there
}

ElementHierarchy::ElementHierarchy(const Model& model) {
  std::optional<Coarsening> next = coarsen(model.mesh.num_nodes(), model.mesh.hexahedra());
  const Partition* finer = model.partition.get();
  while (next && next->num_nodes >= kFewestNodes) {
    levels_.emplace_back(*next, *finer);
    finer = levels_.back().partition.get();
    next = coarsen(next->num_nodes, std::vector<Hexahedron>(next->cells));
  }
}

void ElementHierarchy::update(const Model& model, const Linearization& at, KernelSystem& system) {
  system.coarse.clear();
  for (const Level& level : levels_)
    system.coarse.push_back({.op = &level.op,
                             .prolongation = &level.prolongation,
                             .restriction = &level.restriction,
                             .finer_slot = level.finer_slot.data()});
  if (revision_ == at.revision) return;
  revision_ = at.revision;

  const AlignedVector<double>*material = &at.material, *world = &at.world;
  const ElementOperator<float, float>* finer = nullptr;
  for (Level& level : levels_) {
    place(level.placement, *level.partition, *material, level.material);
    place(level.placement, *level.partition, *world, level.world);
    if (finer)
      gather_weights(level.children, *finer, level.op);
    else
      std::visit([&](const auto& op) { gather_weights(level.children, op, level.op); }, at.op);
    level.op.corner_share = std::visit([](const auto& op) { return op.corner_share; }, at.op);
    parallel_for(level.partition->num_chunks, [&](int chunk) {
      linearize_cells(*level.partition, level.material.data(), level.world.data(), model.settings.gradient,
                      model.length, chunk, level.op);
    });
    material = &level.material;
    world = &level.world;
    finer = &level.op;
  }
}

std::size_t ElementHierarchy::bytes() const {
  std::size_t sum = 0;
  for (const Level& level : levels_) {
    sum += level.op.bytes() + (level.material.size() + level.world.size()) * sizeof(double);
    for (const NodalMap* map : {&level.prolongation, &level.restriction, &level.placement})
      sum += (map->first.size() + map->column.size()) * sizeof(int) + map->weight.size() * sizeof(float);
  }
  return sum;
}

}  // namespace hexaplast
