// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Of each cell, the number of the first one with the same nodes in the same order: its own where there is none before.
template <class Cell>
std::vector<int> first_copies(std::span<const Cell> cells) {
  struct Entry {
    std::uint64_t key;  // of the nodes: sorts faster than they do
    int cell;
  };
  std::vector<Entry> entries;
  entries.reserve(cells.size());
  for (int c = 0; c < static_cast<int>(cells.size()); ++c) {
    std::uint64_t key = 0;
    for (const int node : cells[c]) {
      key = (key ^ static_cast<std::uint64_t>(node)) * 0x9e3779b97f4a7c15u;
      key ^= key >> 32;
    }
    entries.push_back({key, c});
  }
  std::ranges::sort(entries, [&](const Entry& a, const Entry& b) {
    if (a.key != b.key) return a.key < b.key;
    return cells[a.cell] != cells[b.cell] ? cells[a.cell] < cells[b.cell] : a.cell < b.cell;
  });

  std::vector<int> first(cells.size());
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const int cell = entries[k].cell;
    const bool is_copy = k > 0 && cells[cell] == cells[entries[k - 1].cell];
    first[cell] = is_copy ? first[entries[k - 1].cell] : cell;
  }
  return first;
}

/// Throws InputError where two hexahedra have the same eight nodes, in whatever order. It names both.
void require_own_nodes(std::span<const Hexahedron> hexahedra);

}  // namespace hexaplast
