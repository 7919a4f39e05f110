// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layout/runs.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/blocks.hpp"

namespace hexaplast {

namespace {

constexpr double kEnoughRuns = 0.75;  // of the most that any axis gives

/// Elements in a row along a local axis. A ring is cut somewhere, and no run reaches across: its nodes are not in order
/// there.
struct Line {
  std::vector<int> elements;
  bool is_ring;

  std::size_t num_runs() const { return (elements.size() - (is_ring ? 1 : 0)) / kRun; }
};

/// The neighbour across the far face of `axis`, in the same orientation, or -1. first_at: an element per node that has
/// it as its corner 0.
int neighbour(const std::vector<Hexahedron>& hexahedra, const std::vector<int>& first_at, int e, int axis) {
  const int found = first_at[hexahedra[e][kEdgeNeighbour[0][axis]]];
  if (found < 0) return -1;
  for (int a = 0; a < kCorners; ++a)
    if (kCornerSign[a][axis] < 0 && hexahedra[found][a] != hexahedra[e][kEdgeNeighbour[a][axis]]) return -1;
  return found;
}

std::vector<Line> lines_along(const std::vector<Hexahedron>& hexahedra, const std::vector<int>& first_at, int axis) {
  const int count = static_cast<int>(hexahedra.size());
  std::vector<int> next(count);
  std::vector<char> has_previous(count, 0), taken(count, 0);
  for (int e = 0; e < count; ++e) {
    next[e] = neighbour(hexahedra, first_at, e, axis);
    if (next[e] < 0) continue;
    if (has_previous[next[e]])
      next[e] = -1;  // a face that three elements claim
    else
      has_previous[next[e]] = 1;
  }

  std::vector<Line> found;
  const auto take_from = [&](int e, bool is_ring) {
    found.push_back({{}, is_ring});
    for (; e >= 0 && !taken[e]; e = next[e]) {
      found.back().elements.push_back(e);
      taken[e] = 1;
    }
  };
  for (int e = 0; e < count; ++e)
    if (!has_previous[e]) take_from(e, false);
  for (int e = 0; e < count; ++e)
    if (!taken[e]) take_from(e, true);
  return found;
}

struct LinesOfAxis {
  int axis;
  std::vector<Line> lines;
  std::size_t num_runs = 0;
  long stride = 0;  // sum over neighbours in a line of how far apart they are in the mesh

  LinesOfAxis(int of, std::vector<Line> all) : axis(of), lines(std::move(all)) {
    for (const Line& line : lines) {
      num_runs += line.num_runs();
      for (std::size_t k = 1; k < line.elements.size(); ++k)
        stride += std::abs(line.elements[k] - line.elements[k - 1]);
    }
  }
};

/// The axis along which the order of the mesh is kept best, of those that give not much fewer runs than any: what is
/// stored by element lies together then.
LinesOfAxis choose(std::array<LinesOfAxis, 3> axes) {
  std::size_t max = 0;
  for (const LinesOfAxis& each : axes) max = std::max(max, each.num_runs);
  LinesOfAxis* best = nullptr;
  for (LinesOfAxis& each : axes)
    if (each.num_runs >= kEnoughRuns * static_cast<double>(max) && (!best || each.stride < best->stride)) best = &each;
  return std::move(*best);
}

/// Fills blocks with runs, and others with what is left of the lines.
class Blocks {
 public:
  void add(const Line& line) {
    const auto end_of_runs = line.elements.begin() + line.num_runs() * kRun;
    runs_.insert(runs_.end(), line.elements.begin(), end_of_runs);
    if (runs_.size() >= kBlock) flush_runs();
    left_.insert(left_.end(), end_of_runs, line.elements.end());
    if (left_.size() >= kBlock) flush_left();
  }

  std::vector<int> finish() {
    left_.insert(left_.end(), runs_.begin(), runs_.end());
    flush_left();
    if (!left_.empty()) {
      left_.resize(kBlock, -1);
      flush_left();
    }
    return std::move(element_of_place_);
  }

 private:
  void flush_runs() {
    std::size_t first = 0;
    for (; first + kBlock <= runs_.size(); first += kBlock)
      for (int at = 0; at < kRun; ++at)
        for (int run = 0; run < kBlock / kRun; ++run) element_of_place_.push_back(runs_[first + run * kRun + at]);
    runs_.erase(runs_.begin(), runs_.begin() + first);
  }
  void flush_left() {
    const std::size_t whole = left_.size() / kBlock * kBlock;
    element_of_place_.insert(element_of_place_.end(), left_.begin(), left_.begin() + whole);
    left_.erase(left_.begin(), left_.begin() + whole);
  }

  std::vector<int> element_of_place_;
  std::vector<int> runs_, left_;  // elements, not yet in a block
};

}  // namespace

RunOrder order_by_runs(int num_nodes, const std::vector<Hexahedron>& hexahedra) {
  std::vector<int> first_at(num_nodes, -1);
  for (std::size_t e = hexahedra.size(); e-- > 0;) first_at[hexahedra[e][0]] = static_cast<int>(e);

  const LinesOfAxis chosen =
      choose({LinesOfAxis(0, lines_along(hexahedra, first_at, 0)), LinesOfAxis(1, lines_along(hexahedra, first_at, 1)),
              LinesOfAxis(2, lines_along(hexahedra, first_at, 2))});
  RunOrder order{{}, chosen.axis, std::vector<int>(num_nodes, -1)};
  Blocks blocks;
  for (const Line& line : chosen.lines) blocks.add(line);
  order.element_of_place = blocks.finish();
  for (const Hexahedron& corners : hexahedra)
    for (int a = 0; a < kCorners; ++a)
      if (kCornerSign[a][order.axis] < 0) order.next_node[corners[a]] = corners[kEdgeNeighbour[a][order.axis]];
  return order;
}

}  // namespace hexaplast
