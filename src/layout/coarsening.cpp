// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layout/coarsening.hpp"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "base/disjoint_sets.hpp"
#include "mesh/neighbours.hpp"

namespace hexaplast {

namespace {

using Lattice = std::array<int, 3>;

constexpr int kFewestElements = 64;  // below, a few sweeps of smoothing solve the problem
constexpr double kMinGain = 2.5;     // fine elements per cell: less, and the lattice is not worth following

/// Place of every element's corners on the lattice of its chart.
struct Charts {
  std::vector<std::array<int, 6>> across;              // per element and face: the element there, or -1
  std::vector<int> chart;                              // per element
  std::vector<std::array<Lattice, kCorners>> corners;  // per element
};

/// A place on the lattice of one chart.
struct ChartPlace {
  int chart = 0;
  Lattice at{};

  bool operator==(const ChartPlace&) const = default;
};

struct HashOfPlace {
  std::size_t operator()(const ChartPlace& place) const {
    std::uint64_t hash = static_cast<std::uint32_t>(place.chart);
    for (const int i : place.at) {
      hash = (hash ^ static_cast<std::uint32_t>(i)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

/// Looked up, never walked through: no order comes from it.
using NumberAtPlace = std::unordered_map<ChartPlace, int, HashOfPlace>;

Lattice low_corner(const std::array<Lattice, kCorners>& corners) {
  Lattice low = corners[0];
  for (const Lattice& at : corners)
    for (int d = 0; d < 3; ++d) low[d] = std::min(low[d], at[d]);
  return low;
}

/// Follows neighbours across faces from a seed; an element that would land on a place that is taken starts a chart of
/// its own.
Charts find_charts(const std::vector<Hexahedron>& hexahedra) {
  Charts charts;
  charts.across = neighbours_across_faces(hexahedra);
  charts.chart.assign(hexahedra.size(), -1);
  charts.corners.resize(hexahedra.size());
  NumberAtPlace taken;
  std::vector<int> queue;
  int num_charts = 0;

  for (int seed = 0; seed < static_cast<int>(hexahedra.size()); ++seed) {
    if (charts.chart[seed] >= 0) continue;
    for (int a = 0; a < kCorners; ++a)
      for (int d = 0; d < 3; ++d) charts.corners[seed][a][d] = kCornerSign[a][d] > 0;
    charts.chart[seed] = num_charts;
    taken.emplace(ChartPlace{num_charts, {0, 0, 0}}, seed);
    queue = {seed};
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const int e = queue[head];
      for (int side = 0; side < 6; ++side) {
        const int other = charts.across[e][side];
        if (other < 0 || charts.chart[other] >= 0) continue;

        // corners on the shared face keep their places, the others lie one step beyond
        std::array<Lattice, kCorners> places;
        std::array<bool, kCorners> known{};
        for (int a = 0; a < kCorners; ++a)
          for (int b = 0; b < kCorners; ++b)
            if (hexahedra[other][a] == hexahedra[e][b] &&
                std::find(kFaces[side].begin(), kFaces[side].end(), b) != kFaces[side].end()) {
              places[a] = charts.corners[e][b];
              known[a] = true;
            }
        const int on_face = kFaces[side][0];
        Lattice outward{};
        for (int d = 0; d < 3; ++d) {
          const int inner = kEdgeNeighbour[on_face][d];
          if (std::find(kFaces[side].begin(), kFaces[side].end(), inner) != kFaces[side].end()) continue;
          for (int i = 0; i < 3; ++i) outward[i] = charts.corners[e][on_face][i] - charts.corners[e][inner][i];
        }
        bool complete = std::count(known.begin(), known.end(), true) == 4;
        for (int a = 0; a < kCorners && complete; ++a) {
          if (known[a]) continue;
          int from = -1;
          for (const int neighbour : kEdgeNeighbour[a])
            if (known[neighbour]) from = neighbour;
          complete = from >= 0;
          if (complete)
            for (int i = 0; i < 3; ++i) places[a][i] = places[from][i] + outward[i];
        }
        if (!complete || !taken.emplace(ChartPlace{num_charts, low_corner(places)}, other).second) continue;
        charts.chart[other] = num_charts;
        charts.corners[other] = places;
        queue.push_back(other);
      }
    }
    ++num_charts;
  }

  // every chart begins at an even place
  std::vector<Lattice> low(num_charts, Lattice{1 << 20, 1 << 20, 1 << 20});
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    for (int d = 0; d < 3; ++d)
      low[charts.chart[e]][d] = std::min(low[charts.chart[e]][d], low_corner(charts.corners[e])[d]);
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    for (Lattice& at : charts.corners[e])
      for (int d = 0; d < 3; ++d) at[d] -= low[charts.chart[e]][d];
  return charts;
}

int corner_at(int x, int y, int z) {
  for (int a = 0; a < kCorners; ++a)
    if ((kCornerSign[a][0] > 0) == (x > 0) && (kCornerSign[a][1] > 0) == (y > 0) && (kCornerSign[a][2] > 0) == (z > 0))
      return a;
  return 0;
}

/// Cells of 2 x 2 x 2 places, in the order of their first element.
struct Cells {
  std::vector<int> of_element;
  std::vector<int> chart;      // per cell
  std::vector<Lattice> place;  // per cell
  std::vector<std::array<int, kCorners>> children;

  int count() const { return static_cast<int>(place.size()); }
};

Cells find_cells(const Charts& charts) {
  Cells cells;
  NumberAtPlace cell_at;
  for (std::size_t e = 0; e < charts.chart.size(); ++e) {
    const Lattice low = low_corner(charts.corners[e]);
    const Lattice place{low[0] / 2, low[1] / 2, low[2] / 2};
    const auto [found, is_new] = cell_at.emplace(ChartPlace{charts.chart[e], place}, cells.count());
    if (is_new) {
      cells.place.push_back(place);
      cells.chart.push_back(charts.chart[e]);
      cells.children.emplace_back().fill(-1);
    }
    cells.of_element.push_back(found->second);
    cells.children[found->second][corner_at(low[0] % 2, low[1] % 2, low[2] % 2)] = static_cast<int>(e);
  }
  return cells;
}

/// Whether cells of elements that share a face share a corner. They do not across a seam of two charts at which the
/// lattice of one ends within a cell.
bool are_connected(const Charts& charts, const Cells& cells, const std::vector<Hexahedron>& cell_corners) {
  for (std::size_t e = 0; e < charts.across.size(); ++e)
    for (const int other : charts.across[e]) {
      if (other < 0) continue;
      const Hexahedron& beyond = cell_corners[cells.of_element[other]];
      if (std::ranges::find_first_of(cell_corners[cells.of_element[e]], beyond) ==
          cell_corners[cells.of_element[e]].end())
        return false;
    }
  return true;
}

/// Each fine node by the cell in which it needs the fewest corners.
NodalMap trilinear(int num_nodes, const std::vector<Hexahedron>& hexahedra, const Charts& charts, const Cells& cells,
                   const std::vector<Hexahedron>& cell_corners) {
  struct Place {
    int element = -1, corner = -1, needed = kCorners + 1;
  };
  std::vector<Place> best(static_cast<std::size_t>(num_nodes));
  // 0, 1 or 2: at one end of the cell, in the middle, at the other end
  const auto half_steps = [&](int e, int a, int d) {
    return charts.corners[e][a][d] - 2 * cells.place[cells.of_element[e]][d];
  };
  for (int e = 0; e < static_cast<int>(hexahedra.size()); ++e)
    for (int a = 0; a < kCorners; ++a) {
      int needed = 1;
      for (int d = 0; d < 3; ++d) needed *= half_steps(e, a, d) == 1 ? 2 : 1;
      Place& place = best[hexahedra[e][a]];
      if (needed < place.needed) place = {e, a, needed};
    }
  NodalMap map;
  map.first.push_back(0);
  for (const Place& place : best) {
    for (int b = 0; b < kCorners && place.element >= 0; ++b) {
      double weight = 1;
      for (int d = 0; d < 3; ++d) {
        const int at = half_steps(place.element, place.corner, d);
        weight *= at == 1 ? 0.5 : (at == 2) == (kCornerSign[b][d] > 0) ? 1 : 0;
      }
      if (weight == 0) continue;
      map.column.push_back(cell_corners[cells.of_element[place.element]][b]);
      map.weight.push_back(static_cast<float>(weight));
    }
    map.first.push_back(static_cast<int>(map.column.size()));
  }
  return map;
}

/// Each coarse node at its fine node, or by the affine extension of the child that lies nearest to the corner.
NodalMap affine(const std::vector<Hexahedron>& hexahedra, const Charts& charts, const Cells& cells,
                const std::vector<Hexahedron>& cell_corners, const std::vector<int>& fine_node) {
  struct Nearest {
    int child = -1, cell = -1, corner = -1, steps = 4;
  };
  std::vector<Nearest> nearest(fine_node.size());
  for (int c = 0; c < cells.count(); ++c)
    for (int a = 0; a < kCorners; ++a)
      for (int b = 0; b < kCorners; ++b) {
        if (cells.children[c][b] < 0) continue;
        int steps = 0;
        for (int d = 0; d < 3; ++d) steps += kCornerSign[a][d] != kCornerSign[b][d];
        Nearest& at = nearest[cell_corners[c][a]];
        if (steps < at.steps) at = {cells.children[c][b], c, a, steps};
      }
  NodalMap map;
  map.first.push_back(0);
  for (std::size_t node = 0; node < fine_node.size(); ++node) {
    if (fine_node[node] >= 0) {
      map.column.push_back(fine_node[node]);
      map.weight.push_back(1);
    } else {
      // s: the corner in the child's reference cube; x = mean of x_b (1 + s . s_b)
      const Nearest& from = nearest[node];
      const Lattice low = low_corner(charts.corners[from.child]);
      for (int b = 0; b < kCorners; ++b) {
        double weight = 1;
        for (int d = 0; d < 3; ++d) {
          const int target = 2 * (cells.place[from.cell][d] + (kCornerSign[from.corner][d] > 0));
          weight += (2.0 * (target - low[d]) - 1) * (2.0 * (charts.corners[from.child][b][d] - low[d]) - 1);
        }
        map.column.push_back(hexahedra[from.child][b]);
        map.weight.push_back(static_cast<float>(weight / kCorners));
      }
    }
    map.first.push_back(static_cast<int>(map.column.size()));
  }
  return map;
}

}  // namespace

NodalMap NodalMap::transposed(int num_columns) const {
  NodalMap out;
  out.first.assign(num_columns + 1, 0);
  for (const int c : column) ++out.first[c + 1];
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.column.resize(column.size());
  out.weight.resize(weight.size());
  std::vector<int> next = out.first;
  for (int row = 0; row < num_rows(); ++row)
    for (int k = first[row]; k < first[row + 1]; ++k) {
      out.column[next[column[k]]] = row;
      out.weight[next[column[k]]++] = weight[k];
    }
  return out;
}

std::optional<Coarsening> coarsen(int num_nodes, const std::vector<Hexahedron>& hexahedra) {
  if (hexahedra.size() < kFewestElements) return std::nullopt;
  const Charts charts = find_charts(hexahedra);
  const Cells cells = find_cells(charts);
  if (static_cast<double>(hexahedra.size()) < kMinGain * cells.count()) return std::nullopt;

  // coarse nodes: one per even place of a chart, merged where charts, or two ends of one, share a node of the mesh
  Coarsening out;
  NumberAtPlace node_at;
  DisjointSets merged;
  std::vector<int> coarse_of_fine(static_cast<std::size_t>(num_nodes), -1);
  out.cells.resize(cells.place.size());
  for (int c = 0; c < cells.count(); ++c)
    for (int a = 0; a < kCorners; ++a) {
      Lattice place = cells.place[c];
      for (int d = 0; d < 3; ++d) place[d] += kCornerSign[a][d] > 0;
      const auto [found, is_new] = node_at.emplace(ChartPlace{cells.chart[c], place}, merged.num_members());
      if (is_new) merged.add();
      out.cells[c][a] = found->second;
      const int child = cells.children[c][a];
      if (child < 0) continue;
      for (int b = 0; b < kCorners; ++b) {
        const Lattice& at = charts.corners[child][b];
        if (at[0] != 2 * place[0] || at[1] != 2 * place[1] || at[2] != 2 * place[2]) continue;
        int& coarse = coarse_of_fine[hexahedra[child][b]];
        if (coarse < 0)
          coarse = found->second;
        else
          merged.join(coarse, found->second);
      }
    }
  std::vector<int> number(static_cast<std::size_t>(merged.num_members()), -1);
  for (Hexahedron& cell : out.cells)
    for (int& node : cell) {
      int& at = number[merged.root(node)];
      if (at < 0) at = out.num_nodes++;
      node = at;
    }
  for (Hexahedron cell : out.cells) {
    std::sort(cell.begin(), cell.end());
    if (std::adjacent_find(cell.begin(), cell.end()) != cell.end()) return std::nullopt;
  }
  if (!are_connected(charts, cells, out.cells)) return std::nullopt;
  out.fine_node.resize(static_cast<std::size_t>(out.num_nodes), -1);
  for (int n = 0; n < num_nodes; ++n)
    if (coarse_of_fine[n] >= 0) out.fine_node[number[merged.root(coarse_of_fine[n])]] = n;

  out.children = cells.children;
  out.prolongation = trilinear(num_nodes, hexahedra, charts, cells, out.cells);
  out.placement = affine(hexahedra, charts, cells, out.cells, out.fine_node);
  return out;
}

}  // namespace hexaplast
