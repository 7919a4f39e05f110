// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/partition.hpp"

#include <algorithm>

#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

namespace {

// Small enough to keep several threads busy, large enough that the copies between chunks stay a fraction of the nodes.
constexpr int kElementsPerChunk = 1024, kMostChunks = 16;

}  // namespace

Partition::Partition(int count, const std::vector<Hexahedron>& hexahedra)
    : num_nodes(count), num_elements(static_cast<int>(hexahedra.size())) {
  num_blocks = (num_elements + kBlock - 1) / kBlock;
  num_chunks = std::clamp(num_elements / kElementsPerChunk, 1, kMostChunks);
  first_block.resize(num_chunks + 1);
  for (int c = 0; c <= num_chunks; ++c)
    first_block[c] = static_cast<int>(static_cast<long>(num_blocks) * c / num_chunks);

  // a node belongs to the first chunk that touches it; one without element to the first chunk
  const auto for_each_corner = [&](int chunk, const auto& visit) {
    const int last = std::min(first_block[chunk + 1] * kBlock, num_elements);
    for (int e = first_block[chunk] * kBlock; e < last; ++e)
      for (int a = 0; a < kCorners; ++a) visit(e, a, hexahedra[e][a]);
  };
  std::vector<int> chunk_of_node(num_nodes, -1);
  for (int c = 0; c < num_chunks; ++c)
    for_each_corner(c, [&](int, int, int node) {
      if (chunk_of_node[node] < 0) chunk_of_node[node] = c;
    });
  for (int& c : chunk_of_node) c = std::max(c, 0);

  first_node.assign(num_chunks + 1, 0);
  for (const int c : chunk_of_node) ++first_node[c + 1];
  for (int c = 0; c < num_chunks; ++c) first_node[c + 1] += first_node[c];
  slot_of_node.resize(num_nodes);
  node_of_slot.resize(num_nodes);
  std::vector<int> next = first_node;
  for (int node = 0; node < num_nodes; ++node) {
    slot_of_node[node] = next[chunk_of_node[node]]++;
    node_of_slot[slot_of_node[node]] = node;
  }

  // copies, in ascending order of the node's slot within each chunk
  first_copy.assign(num_chunks + 1, num_nodes);
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
    first_copy[c + 1] = num_nodes + static_cast<int>(original.size());
    for_each_corner(c, [&](int e, int a, int node) {
      const std::size_t at = (static_cast<std::size_t>(e / kBlock) * kCorners + a) * kBlock + e % kBlock;
      corner[at] = chunk_of_node[node] == c ? slot_of_node[node] : slot_here[node];
    });
  }
  num_slots = num_nodes + static_cast<int>(original.size()) + kCorners;
  for (int e = num_elements; e < num_blocks * kBlock; ++e)
    for (int a = 0; a < kCorners; ++a)
      corner[(static_cast<std::size_t>(e / kBlock) * kCorners + a) * kBlock + e % kBlock] = absent_slot() + a;

  // each owner receives its copies back in the order of its nodes, and of the chunks for one node
  returned_copy.resize(original.size());
  for (std::size_t k = 0; k < original.size(); ++k) returned_copy[k] = num_nodes + static_cast<int>(k);
  std::stable_sort(returned_copy.begin(), returned_copy.end(),
                   [&](int a, int b) { return original[a - num_nodes] < original[b - num_nodes]; });
  first_return.resize(num_chunks + 1);
  for (int c = 0; c <= num_chunks; ++c)
    first_return[c] =
        static_cast<int>(std::lower_bound(returned_copy.begin(), returned_copy.end(), first_node[c],
                                          [&](int copy, int slot) { return original[copy - num_nodes] < slot; }) -
                         returned_copy.begin());
}

template <class T>
void to_slots(const Partition& partition, ConstPoints field, AlignedVector<T>& slots) {
  parallel_for(partition.num_chunks, [&](int chunk) {
    const auto put = [&](int slot, int from) {
      T* to = slots.data() + 4 * static_cast<std::size_t>(slot);
      const double* row = field.data() + 3 * static_cast<std::size_t>(partition.node_of_slot[from]);
      for (int i = 0; i < 3; ++i) to[i] = static_cast<T>(row[i]);
    };
    for (int slot = partition.first_node[chunk]; slot < partition.first_node[chunk + 1]; ++slot) put(slot, slot);
    for (int slot = partition.first_copy[chunk]; slot < partition.first_copy[chunk + 1]; ++slot)
      put(slot, partition.original[slot - partition.num_nodes]);
  });
}
template void to_slots(const Partition&, ConstPoints, AlignedVector<double>&);
template void to_slots(const Partition&, ConstPoints, AlignedVector<float>&);

}  // namespace hexaplast
