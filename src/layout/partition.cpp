// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layout/partition.hpp"

#include <algorithm>

#include "base/require.hpp"
#include "hexaplast/base/parallel.hpp"
#include "layout/runs.hpp"

namespace hexaplast {

namespace {

// Small enough to keep several threads busy, large enough that ghost nodes stay a fraction of the nodes.
constexpr int kElementsPerChunk = 512, kMaxChunks = 16;

std::size_t corner_index(int place, int corner) {
  return (static_cast<std::size_t>(place / kBlock) * kCorners + corner) * kBlock + place % kBlock;
}

/// Whether the corners of each run lie in slots side by side.
bool lies_in_runs(const int* corner) {
  constexpr int kRuns = kBlock / kRun;
  for (int a = 0; a < kCorners; ++a)
    for (int place = kRuns; place < kBlock; ++place)
      if (corner[a * kBlock + place] != corner[a * kBlock + place - kRuns] + 1) return false;
  return true;
}

}  // namespace

Partition::Partition(int count, const std::vector<Hexahedron>& hexahedra)
    : num_nodes(count), num_elements(static_cast<int>(hexahedra.size())) {
  RunOrder order = order_by_runs(num_nodes, hexahedra);
  element_of_place = std::move(order.element_of_place);
  place_of_element.resize(num_elements);
  for (std::size_t place = 0; place < element_of_place.size(); ++place)
    if (element_of_place[place] >= 0) place_of_element[element_of_place[place]] = static_cast<int>(place);
  num_blocks = static_cast<int>(element_of_place.size()) / kBlock;
  num_chunks = std::clamp(num_elements / kElementsPerChunk, 1, kMaxChunks);
  first_block.resize(num_chunks + 1);
  for (int c = 0; c <= num_chunks; ++c)
    first_block[c] = static_cast<int>(static_cast<long>(num_blocks) * c / num_chunks);

  // a node belongs to the first chunk that touches it; one without element to the first chunk
  const auto for_each_corner = [&](int chunk, const auto& visit) {
    for (int place = first_block[chunk] * kBlock; place < first_block[chunk + 1] * kBlock; ++place)
      for (int a = 0; a < kCorners && element_of_place[place] >= 0; ++a)
        visit(place, a, hexahedra[element_of_place[place]][a]);
  };
  std::vector<int> chunk_of_node(num_nodes, -1);
  for (int c = 0; c < num_chunks; ++c)
    for_each_corner(c, [&](int, int, int node) {
      if (chunk_of_node[node] < 0) chunk_of_node[node] = c;
    });
  for (int& c : chunk_of_node) c = std::max(c, 0);

  // the nodes of a chunk along the runs
  slot_of_node.assign(num_nodes, -1);
  first_node.assign(num_chunks + 1, 0);
  for (int c = 0; c < num_chunks; ++c) {
    const auto number = [&](int node) {
      for (; node >= 0 && chunk_of_node[node] == c && slot_of_node[node] < 0; node = order.next_node[node]) {
        slot_of_node[node] = static_cast<int>(node_of_slot.size());
        node_of_slot.push_back(node);
      }
    };
    for (const bool starts_runs : {true, false})
      for_each_corner(c, [&](int, int a, int node) {
        if ((kCornerSign[a][order.axis] < 0) == starts_runs) number(node);
      });
    for (int node = 0; c == 0 && node < num_nodes; ++node) number(node);
    first_node[c + 1] = static_cast<int>(node_of_slot.size());
  }

  // ghosts, in ascending order of the node's slot within each chunk
  first_ghost.assign(num_chunks + 1, num_nodes);
  std::vector<int> slot_here(num_nodes, -1);  // of a node, in the chunk at hand
  corner.resize(static_cast<std::size_t>(num_blocks) * kCorners * kBlock);
  for (int c = 0; c < num_chunks; ++c) {
    std::vector<int> borrowed;
    for_each_corner(c, [&](int, int, int node) {
      if (chunk_of_node[node] != c) borrowed.push_back(slot_of_node[node]);
    });
    std::sort(borrowed.begin(), borrowed.end());
    borrowed.erase(std::unique(borrowed.begin(), borrowed.end()), borrowed.end());
    for (const int slot : borrowed) {
      slot_here[node_of_slot[slot]] = num_nodes + static_cast<int>(original.size());
      original.push_back(slot);
    }
    first_ghost[c + 1] = num_nodes + static_cast<int>(original.size());
    for_each_corner(c, [&](int place, int a, int node) {
      corner[corner_index(place, a)] = chunk_of_node[node] == c ? slot_of_node[node] : slot_here[node];
    });
  }
  num_slots = num_nodes + static_cast<int>(original.size()) + kCorners;
  for (int place = 0; place < num_blocks * kBlock; ++place)
    for (int a = 0; a < kCorners && element_of_place[place] < 0; ++a)
      corner[corner_index(place, a)] = absent_slot() + a;
  is_run.resize(num_blocks);
  for (int block = 0; block < num_blocks; ++block) is_run[block] = lies_in_runs(corners(block));

  // each owner receives its ghosts back in the order of its nodes, and of the chunks for one node
  reduced_ghost.resize(original.size());
  for (std::size_t k = 0; k < original.size(); ++k) reduced_ghost[k] = num_nodes + static_cast<int>(k);
  std::stable_sort(reduced_ghost.begin(), reduced_ghost.end(),
                   [&](int a, int b) { return original[a - num_nodes] < original[b - num_nodes]; });
  first_reduced.resize(num_chunks + 1);
  for (int c = 0; c <= num_chunks; ++c)
    first_reduced[c] =
        static_cast<int>(std::lower_bound(reduced_ghost.begin(), reduced_ghost.end(), first_node[c],
                                          [&](int ghost, int slot) { return original[ghost - num_nodes] < slot; }) -
                         reduced_ghost.begin());
}

void SlotScratch::resize(const Partition& partition) {
  for (AlignedVector<double>* vector : {&first, &second}) {
    vector->resize(4 * static_cast<std::size_t>(partition.num_slots), 0.0);
    std::fill(vector->end() - 4 * kCorners, vector->end(), 0.0);
  }
}

template <class T>
void to_slots(const Partition& partition, ConstPoints field, AlignedVector<T>& slots, double factor) {
  require_rows("to_slots", "field", field, partition.num_nodes);
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto put = [&](int slot, int from) {
      T* to = slots.data() + 4 * static_cast<std::size_t>(slot);
      const double* row = field.data() + 3 * static_cast<std::size_t>(partition.node_of_slot[from]);
      for (int i = 0; i < 3; ++i) to[i] = static_cast<T>(factor * row[i]);
    };
    for (int slot = partition.first_node[chunk]; slot < partition.first_node[chunk + 1]; ++slot) put(slot, slot);
    for (int slot = partition.first_ghost[chunk]; slot < partition.first_ghost[chunk + 1]; ++slot)
      put(slot, partition.original[slot - partition.num_nodes]);
  });
}
template void to_slots(const Partition&, ConstPoints, AlignedVector<double>&, double);
template void to_slots(const Partition&, ConstPoints, AlignedVector<float>&, double);

}  // namespace hexaplast
