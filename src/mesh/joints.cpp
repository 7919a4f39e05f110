// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/joints.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "base/disjoint_sets.hpp"

namespace hexaplast {

namespace {

bool has_corner(int side, int corner) { return std::ranges::find(kFaces[side], corner) != kFaces[side].end(); }

/// Whether two corners, which are one node, are ends of an edge that both hexahedra have.
bool share_an_edge(const Hexahedron& one, int corner, const Hexahedron& other, int other_corner) {
  for (const int a : kEdgeNeighbour[corner])
    for (const int b : kEdgeNeighbour[other_corner])
      if (one[a] == other[b]) return true;
  return false;
}

}  // namespace

Joints::Joints(const HexMesh& initial) : across_(initial.num_elements()) {
  for (auto& sides : across_) sides.fill(-1);
  struct Entry {
    Quad nodes;  // sorted
    int hexahedron, side;
  };
  std::vector<Entry> entries;
  entries.reserve(across_.size() * 6);
  for (int e = 0; e < initial.num_elements(); ++e)
    for (int side = 0; side < 6; ++side)
      entries.push_back({sorted(face_of(initial.hexahedra()[e], kFaces[side])), e, side});
  std::ranges::sort(entries, {}, [](const Entry& entry) { return std::tuple(entry.nodes, entry.hexahedron); });

  std::vector<std::pair<int, int>> ranges;  // of entries, of two or more hexahedra
  for (int first = 0, end = 0; first < std::ssize(entries); first = end) {
    while (end < std::ssize(entries) && entries[end].nodes == entries[first].nodes) ++end;
    if (end - first > 1) ranges.emplace_back(first, end);
  }
  std::ranges::sort(ranges, {}, [&](const auto& range) {
    return std::pair(entries[range.first].hexahedron, entries[range.first].side);
  });
  for (const auto& [first, end] : ranges) {
    for (int k = first; k < end; ++k) {
      across_[entries[k].hexahedron][entries[k].side] = num_faces();
      hexahedra_.values.push_back(entries[k].hexahedron);
    }
    nodes_.values.insert(nodes_.values.end(), entries[first].nodes.begin(), entries[first].nodes.end());
    hexahedra_.close();
    nodes_.close();
    faces_.push_back({entries[first].hexahedron, entries[first].side});
  }

  std::map<std::pair<int, int>, std::vector<int>> nodes_of_hinge;  // few
  for (int n = 0; n < initial.num_nodes(); ++n) {
    const std::span<const HexMesh::Incidence> around = initial.incident(n);
    const int count = static_cast<int>(around.size());
    DisjointSets groups(count);
    for (int k = 0; k < count; ++k)
      for (int side = 0; side < 6; ++side) {
        const int face = across_[around[k].element][side];
        if (face < 0 || !has_corner(side, around[k].corner)) continue;
        groups.join(std::ranges::find(around, hexahedra(face).front(), &HexMesh::Incidence::element) - around.begin(),
                    k);
      }
    if (groups.num_sets() < 2) continue;
    std::vector<bool> stands_before(count, false);
    for (int k = 0; k < count; ++k) {  // the lowest hexahedron of its group, unless that stands before
      if (stands_before[k]) continue;
      const auto is_of_group = [&](int other) { return groups.root(other) == groups.root(k); };
      std::pair<int, int> pair{-1, -1};
      for (int before = 0; before < count && pair.first < 0; ++before)
        for (int of_group = 0; of_group < count && pair.first < 0 && stands_before[before]; ++of_group)
          if (is_of_group(of_group) &&
              share_an_edge(initial.hexahedra()[around[before].element], around[before].corner,
                            initial.hexahedra()[around[of_group].element], around[of_group].corner))
            pair = std::minmax({around[before].element, around[of_group].element});
      if (pair.first < 0) pair = {around[0].element, around[k].element};
      if (k > 0) nodes_of_hinge[pair].push_back(n);
      for (int other = k; other < count; ++other)
        if (is_of_group(other)) stands_before[other] = true;
    }
  }
  std::vector<std::pair<int, int>> at_nodes;  // node and hinge
  for (const auto& [pair, nodes] : nodes_of_hinge) {
    for (const int n : nodes) at_nodes.emplace_back(n, count());
    hexahedra_.values.insert(hexahedra_.values.end(), {pair.first, pair.second});
    nodes_.values.insert(nodes_.values.end(), nodes.begin(), nodes.end());
    hexahedra_.close();
    nodes_.close();
    hinges_.push_back({pair.first, pair.second});
  }
  std::ranges::sort(at_nodes);
  auto next = at_nodes.begin();
  for (int n = 0; n < initial.num_nodes(); ++n) {
    for (; next != at_nodes.end() && next->first == n; ++next) hinges_at_.values.push_back(next->second);
    hinges_at_.close();
  }
}

int Joints::find(Face face) const {
  const bool exists = face.hexahedron >= 0 && face.hexahedron < std::ssize(across_) && face.side >= 0 && face.side < 6;
  return exists ? across_[face.hexahedron][face.side] : -1;
}

int Joints::find(Hinge hinge) const {
  const auto at = std::ranges::lower_bound(hinges_, std::pair(hinge.first, hinge.second), {},
                                           [](const Hinge& one) { return std::pair(one.first, one.second); });
  return at != hinges_.end() && *at == hinge ? num_faces() + static_cast<int>(at - hinges_.begin()) : -1;
}

}  // namespace hexaplast
