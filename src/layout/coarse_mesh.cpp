// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layout/coarse_mesh.hpp"

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

}  // namespace

CoarseMesh::CoarseMesh(const Coarsening& coarsening, const Partition& finer)
    : partition(std::make_shared<const Partition>(coarsening.num_nodes, coarsening.cells)),
      cells(coarsening.cells),
      children(coarsening.children),
      prolongation(by_slots(coarsening.prolongation, finer, *partition)),
      restriction(prolongation.transposed(coarsening.num_nodes)),
      placement(by_slots(coarsening.placement, *partition, finer)) {
  for (int slot = 0; slot < partition->num_nodes; ++slot) {
    const int fine = coarsening.fine_node[partition->node_of_slot[slot]];
    finer_slot.push_back(fine < 0 ? -1 : finer.slot_of_node[fine]);
  }
}

void CoarseMesh::place(const AlignedVector<double>& finer, AlignedVector<double>& positions) const {
  parallel_for(partition->num_nodes, [&](int slot) {
    double at[3] = {0, 0, 0};
    for (int k = placement.first[slot]; k < placement.first[slot + 1]; ++k)
      for (int i = 0; i < 3; ++i)
        at[i] +=
            static_cast<double>(placement.weight[k]) * finer[4 * static_cast<std::size_t>(placement.column[k]) + i];
    for (int i = 0; i < 3; ++i) positions[4 * static_cast<std::size_t>(slot) + i] = at[i];
  });
  parallel_for(partition->num_chunks, [&](int chunk) { update_ghosts(*partition, chunk, positions.data()); });
}

std::vector<CoarseMesh> coarse_meshes(const Charts& charts, const HexMesh& mesh, const Partition& partition) {
  std::vector<CoarseMesh> levels;
  std::optional<Coarsening> latest;
  const Partition* finer = &partition;
  for (const Charts::Level& of_charts : charts.levels) {
    latest = latest ? coarsen(of_charts, latest->num_nodes, latest->cells, latest->chart_cell)
                    : coarsen(of_charts, mesh.num_nodes(), mesh.hexahedra());
    if (!latest || latest->num_nodes < kFewestNodes) break;
    levels.emplace_back(*latest, *finer);
    finer = levels.back().partition.get();
  }
  return levels;
}

}  // namespace hexaplast
