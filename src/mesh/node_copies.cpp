// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/node_copies.hpp"

#include <algorithm>
#include <numeric>

#include "base/disjoint_sets.hpp"

namespace hexaplast {

namespace {

int corner_at(const Hexahedron& corners, int node) {
  return static_cast<int>(std::ranges::find(corners, node) - corners.begin());
}

}  // namespace

NodeCopies::NodeCopies(int num_initial_nodes)
    : num_initial_(num_initial_nodes),
      initial_(num_initial_nodes),
      share_(num_initial_nodes, 1.0),
      first_(num_initial_nodes + 1),
      copies_(num_initial_nodes) {
  std::iota(initial_.begin(), initial_.end(), 0);
  std::iota(first_.begin(), first_.end(), 0);
  std::iota(copies_.begin(), copies_.end(), 0);
}

std::vector<int> NodeCopies::split(const HexMesh& initial, const Joints& joints, std::span<const int> opened,
                                   std::span<const int> end_of_call, std::vector<unsigned char>& is_open,
                                   std::span<const double> volume, std::vector<Hexahedron>& hexahedra) {
  std::vector<int> parents;
  int first = 0;
  for (const int end : end_of_call) {
    const std::span<const int> of_call = opened.subspan(first, end - first);
    for (const int joint : of_call) is_open[joint] = 1;
    split_call(initial, joints, of_call, is_open, hexahedra, parents);
    first = end;
  }
  if (!parents.empty()) find_shares(initial, volume, hexahedra);
  return parents;
}

void NodeCopies::split_call(const HexMesh& initial, const Joints& joints, std::span<const int> opened,
                            std::span<const unsigned char> is_open, std::vector<Hexahedron>& hexahedra,
                            std::vector<int>& parents) {
  std::vector<int> candidates;
  for (const int joint : opened)
    for (const int e : joints.hexahedra(joint))
      for (const int n : joints.nodes(joint)) candidates.push_back(hexahedra[e][corner_at(initial.hexahedra()[e], n)]);
  std::ranges::sort(candidates);
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());

  std::vector<HexMesh::Incidence> around;
  DisjointSets groups;
  for (const int node : candidates) {
    around.clear();
    for (const HexMesh::Incidence& at : initial.incident(initial_[node]))
      if (hexahedra[at.element][at.corner] == node) around.push_back(at);
    const int count = static_cast<int>(around.size());
    const auto position = [&](int e) {
      return static_cast<int>(std::ranges::lower_bound(around, e, {}, &HexMesh::Incidence::element) - around.begin());
    };
    groups.assign(count);
    const auto join_at = [&](int joint) {
      if (joint < 0 || is_open[joint]) return;
      const std::span<const int> held = joints.hexahedra(joint);
      for (const int e : held) groups.join(position(held.front()), position(e));
    };
    for (const auto& [element, corner] : around)
      for (int side = 0; side < 6; ++side)
        if (std::ranges::find(kFaces[side], corner) != kFaces[side].end()) join_at(joints.across(element)[side]);
    for (const int hinge : joints.hinges_at(initial_[node]))
      if (const int e = joints.hexahedra(hinge).front();
          hexahedra[e][corner_at(initial.hexahedra()[e], initial_[node])] == node)
        join_at(hinge);
    if (groups.num_sets() < 2) continue;

    std::vector<int> number(count, -1);  // of the group's copy, at its root
    for (int k = 0; k < count; ++k) {
      int& copy = number[groups.root(k)];
      if (copy < 0 && k == 0) copy = node;
      if (copy < 0) {
        copy = num_nodes();
        initial_.push_back(initial_[node]);
        parents.push_back(node);
      }
      hexahedra[around[k].element][around[k].corner] = copy;
    }
  }
}

void NodeCopies::find_shares(const HexMesh& initial, std::span<const double> volume,
                             std::span<const Hexahedron> hexahedra) {
  first_.assign(num_initial_ + 1, 0);
  for (const int n : initial_) ++first_[n + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  copies_.resize(initial_.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int node = 0; node < num_nodes(); ++node) copies_[next[initial_[node]]++] = node;

  share_.assign(initial_.size(), 1);
  for (int n = 0; n < num_initial_; ++n) {
    if (of(n).size() == 1) continue;
    double all = 0;
    for (const int copy : of(n)) share_[copy] = 0;
    for (const auto& [element, corner] : initial.incident(n)) {
      share_[hexahedra[element][corner]] += volume[element];
      all += volume[element];
    }
    for (const int copy : of(n)) share_[copy] /= all;
  }
}

}  // namespace hexaplast
