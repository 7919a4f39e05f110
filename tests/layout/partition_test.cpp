// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layout/partition.hpp"

#include "support/core.hpp"

namespace hexaplast {
namespace {

/// The node that a slot stands for.
int node(const Partition& partition, int slot) {
  return partition.node_of_slot[slot < partition.num_nodes ? slot : partition.original[slot - partition.num_nodes]];
}

/// Every element has one place, and its corners there are the mesh's; blocks that are called runs are runs.
void expect_whole(const Partition& partition, const std::vector<Hexahedron>& hexahedra) {
  std::vector<int> found(hexahedra.size(), 0);
  for (int block = 0; block < partition.num_blocks; ++block)
    for (int place = 0; place < kBlock; ++place) {
      const int e = partition.element(block, place);
      const int* corners = partition.corners(block) + place;
      for (int a = 0; a < kCorners; ++a) {
        if (e >= 0) {
          EXPECT_EQ(node(partition, corners[a * kBlock]), hexahedra[e][a]);
        } else {
          EXPECT_EQ(corners[a * kBlock], partition.absent_slot() + a);
        }
        if (partition.is_run[block] && place >= 4) {
          EXPECT_EQ(corners[a * kBlock], corners[a * kBlock - 4] + 1);
        }
      }
      if (e < 0) {
        EXPECT_EQ(block, partition.num_blocks - 1);
      } else {
        ++found[e];
        EXPECT_EQ(partition.place_of_element[e], block * kBlock + place);
      }
    }
  EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](int times) { return times == 1; }));
  for (int n = 0; n < partition.num_nodes; ++n) EXPECT_EQ(partition.node_of_slot[partition.slot_of_node[n]], n);
}

int num_runs(const Partition& partition) {
  return static_cast<int>(std::count(partition.is_run.begin(), partition.is_run.end(), 1));
}

TEST(Partition, WhatIsLeftOfTheLinesComesLast) {
  const HexMesh mesh = support::block({5, 3, 7}, 0.1);  // 21 runs along x; 15 along z
  const Partition partition(mesh);
  expect_whole(partition, mesh.hexahedra());
  EXPECT_EQ(num_runs(partition), 5);
  EXPECT_EQ(partition.num_blocks, (mesh.num_elements() + kBlock - 1) / kBlock);
}

/// The fraction of sixteen threads' time in which they work, a chunk each, in an iteration of conjugate gradients. In
/// nanoseconds: a product of an element, vectors of a node, copies of a ghost, as docs/performance.md has them for
/// boxes.
double efficiency_of_sixteen(const Partition& partition) {
  constexpr double kProduct = 12, kVectors = 3, kCopies = 1;
  double sum = 0, longest = 0;
  for (int c = 0; c < partition.num_chunks; ++c) {
    const auto count = [&](const std::vector<int>& first) { return first[c + 1] - first[c]; };
    const double time = kProduct * kBlock * count(partition.first_block) + kVectors * count(partition.first_node) +
                        kCopies * count(partition.first_ghost);
    sum += time;
    longest = std::max(longest, time);
  }
  return sum / (16 * longest);
}

TEST(Partition, KeepsSixteenThreadsBusyAndMostRuns) {
  for (const std::array<int, 3> cells : {std::array{18, 18, 32}, std::array{40, 40, 64}, std::array{75, 15, 15}}) {
    const HexMesh mesh = support::block(cells, 0.1);
    const Partition partition(mesh);
    expect_whole(partition, mesh.hexahedra());
    EXPECT_GT(num_runs(partition), 0.88 * partition.num_blocks);
    EXPECT_EQ(partition.num_chunks, 16);
    EXPECT_GT(efficiency_of_sixteen(partition), 0.9);
  }
}

TEST(Partition, TurnedElementsAreInNobodysRun) {
  // every element in an orientation of its own: no common axis, no order
  const HexMesh mesh = support::block({4, 5, 6}, 0.1);
  constexpr std::array<std::array<int, kCorners>, 3> kTurns{
      {{0, 1, 2, 3, 4, 5, 6, 7}, {1, 2, 3, 0, 5, 6, 7, 4}, {0, 3, 7, 4, 1, 2, 6, 5}}};
  Random random(7);
  std::vector<Hexahedron> hexahedra = mesh.hexahedra();
  for (Hexahedron& hexahedron : hexahedra) {
    const Hexahedron before = hexahedron;
    const auto& turn = kTurns[static_cast<int>(1.5 + 1.5 * random.field(1, 0.999)(0, 0))];
    for (int a = 0; a < kCorners; ++a) hexahedron[a] = before[turn[a]];
  }
  expect_whole(Partition(mesh.num_nodes(), hexahedra), hexahedra);
}

TEST(Partition, ThreeElementsOnOneFaceAndNodesWithoutElementHavePlaces) {
  std::vector<Hexahedron> hexahedra{{0, 1, 2, 3, 4, 5, 6, 7}};
  for (int copy = 0; copy < 3; ++copy) {
    const int first = 8 + 4 * copy;
    hexahedra.push_back({1, first, first + 1, 2, 5, first + 2, first + 3, 6});
  }
  expect_whole(Partition(22, hexahedra), hexahedra);  // two nodes more than elements touch
}

}  // namespace
}  // namespace hexaplast
