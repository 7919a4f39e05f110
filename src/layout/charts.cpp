// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layout/charts.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "base/disjoint_sets.hpp"
#include "mesh/neighbours.hpp"

namespace hexaplast {

namespace {

using Lattice = std::array<int, 3>;

constexpr int kFewestElements = 64;  // below, a few sweeps of smoothing solve the problem

/// Place of every element's corners on the lattice of its chart.
struct Places {
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
Places find_places(const std::vector<Hexahedron>& hexahedra, const std::vector<std::array<int, 6>>& across) {
  Places found;
  found.chart.assign(hexahedra.size(), -1);
  found.corners.resize(hexahedra.size());
  NumberAtPlace taken;
  std::vector<int> queue;
  int num_charts = 0;

  for (int seed = 0; seed < static_cast<int>(hexahedra.size()); ++seed) {
    if (found.chart[seed] >= 0) continue;
    for (int a = 0; a < kCorners; ++a)
      for (int d = 0; d < 3; ++d) found.corners[seed][a][d] = kCornerSign[a][d] > 0;
    found.chart[seed] = num_charts;
    taken.emplace(ChartPlace{num_charts, {0, 0, 0}}, seed);
    queue = {seed};
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const int e = queue[head];
      for (int side = 0; side < 6; ++side) {
        const int other = across[e][side];
        if (other < 0 || found.chart[other] >= 0) continue;

        // corners on the shared face keep their places, the others lie one step beyond
        std::array<Lattice, kCorners> places;
        std::array<bool, kCorners> known{};
        for (int a = 0; a < kCorners; ++a)
          for (int b = 0; b < kCorners; ++b)
            if (hexahedra[other][a] == hexahedra[e][b] &&
                std::find(kFaces[side].begin(), kFaces[side].end(), b) != kFaces[side].end()) {
              places[a] = found.corners[e][b];
              known[a] = true;
            }
        const int on_face = kFaces[side][0];
        Lattice outward{};
        for (int d = 0; d < 3; ++d) {
          const int inner = kEdgeNeighbour[on_face][d];
          if (std::find(kFaces[side].begin(), kFaces[side].end(), inner) != kFaces[side].end()) continue;
          for (int i = 0; i < 3; ++i) outward[i] = found.corners[e][on_face][i] - found.corners[e][inner][i];
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
        found.chart[other] = num_charts;
        found.corners[other] = places;
        queue.push_back(other);
      }
    }
    ++num_charts;
  }

  // every chart begins at an even place
  std::vector<Lattice> low(num_charts, Lattice{1 << 20, 1 << 20, 1 << 20});
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    for (int d = 0; d < 3; ++d)
      low[found.chart[e]][d] = std::min(low[found.chart[e]][d], low_corner(found.corners[e])[d]);
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    for (Lattice& at : found.corners[e])
      for (int d = 0; d < 3; ++d) at[d] -= low[found.chart[e]][d];
  return found;
}

/// Cells of 2 x 2 x 2 places, in the order of their first element.
struct Cells {
  std::vector<int> of_element;
  std::vector<int> chart;      // per cell
  std::vector<Lattice> place;  // per cell

  int count() const { return static_cast<int>(place.size()); }
};

Cells find_cells(const Places& places) {
  Cells cells;
  NumberAtPlace cell_at;
  for (std::size_t e = 0; e < places.chart.size(); ++e) {
    const Lattice low = low_corner(places.corners[e]);
    const Lattice place{low[0] / 2, low[1] / 2, low[2] / 2};
    const auto [found, is_new] = cell_at.emplace(ChartPlace{places.chart[e], place}, cells.count());
    if (is_new) {
      cells.place.push_back(place);
      cells.chart.push_back(places.chart[e]);
    }
    cells.of_element.push_back(found->second);
  }
  return cells;
}

/// Whether cells of elements that share a face share a corner. They do not across a seam of two charts at which the
/// lattice of one ends within a cell.
bool are_connected(const std::vector<std::array<int, 6>>& across, const Cells& cells,
                   const std::vector<Hexahedron>& cell_corners) {
  for (std::size_t e = 0; e < across.size(); ++e)
    for (const int other : across[e]) {
      if (other < 0) continue;
      const Hexahedron& beyond = cell_corners[cells.of_element[other]];
      if (std::ranges::find_first_of(cell_corners[cells.of_element[e]], beyond) ==
          cell_corners[cells.of_element[e]].end())
        return false;
    }
  return true;
}

/// Joins nodes that lie at one place of a chart.
std::vector<Hexahedron> find_points(int num_nodes, const std::vector<Hexahedron>& hexahedra, const Places& places) {
  DisjointSets points(num_nodes);
  NumberAtPlace node_at;
  std::vector<ChartPlace> latest(static_cast<std::size_t>(num_nodes), ChartPlace{-1, {}});  // of a node
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    for (int a = 0; a < kCorners; ++a) {
      const int node = hexahedra[e][a];
      const ChartPlace place{places.chart[e], places.corners[e][a]};
      if (latest[node] == place) continue;
      latest[node] = place;
      const auto [found, is_new] = node_at.emplace(place, node);
      if (!is_new) points.join(found->second, node);
    }
  std::vector<Hexahedron> of_corners = hexahedra;
  for (Hexahedron& corners : of_corners)
    for (int& at : corners) at = points.root(at);
  return of_corners;
}

/// Coarse points: one per even place of a chart, merged where charts, or two ends of one, share a node of the mesh.
void find_coarse_points(int num_nodes, const std::vector<Hexahedron>& hexahedra, const Cells& cells,
                        Charts::Level& level) {
  NumberAtPlace point_at;
  DisjointSets merged;
  level.cells.resize(cells.place.size());
  for (int c = 0; c < cells.count(); ++c)
    for (int a = 0; a < kCorners; ++a) {
      Lattice place = cells.place[c];
      for (int d = 0; d < 3; ++d) place[d] += kCornerSign[a][d] > 0;
      const auto [found, is_new] = point_at.emplace(ChartPlace{cells.chart[c], place}, merged.num_members());
      if (is_new) merged.add();
      level.cells[c][a] = found->second;
    }
  std::vector<int> coarse_of_fine(static_cast<std::size_t>(num_nodes), -1);
  for (std::size_t e = 0; e < hexahedra.size(); ++e)
    for (int a = 0; a < kCorners; ++a)
      if (const CornersAround& around = kCornersAround[level.elements[e].place[a]]; around.count == 1) {
        const int point = level.cells[cells.of_element[e]][around.corner[0]];
        int& coarse = coarse_of_fine[hexahedra[e][a]];
        if (coarse < 0)
          coarse = point;
        else
          merged.join(coarse, point);
      }
  std::vector<int> number(static_cast<std::size_t>(merged.num_members()), -1);
  for (Hexahedron& cell : level.cells)
    for (int& point : cell) {
      int& at = number[merged.root(point)];
      if (at < 0) at = level.num_coarse_points++;
      point = at;
    }
}

std::optional<Charts::Level> find_level(int num_nodes, const std::vector<Hexahedron>& hexahedra,
                                        const std::vector<std::array<int, 6>>& across) {
  if (hexahedra.size() < kFewestElements) return std::nullopt;
  const Places places = find_places(hexahedra, across);
  const Cells cells = find_cells(places);
  if (static_cast<double>(hexahedra.size()) < kMinGain * cells.count()) return std::nullopt;

  Charts::Level level;
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    const Lattice low = low_corner(places.corners[e]);
    Charts::Element& element = level.elements.emplace_back();
    element.cell = cells.of_element[e];
    element.slot = kCornersAround[2 * (low[0] % 2) + 6 * (low[1] % 2) + 18 * (low[2] % 2)].corner[0];
    for (int a = 0; a < kCorners; ++a) {
      int place = 0;
      for (int d = 2; d >= 0; --d) place = 3 * place + places.corners[e][a][d] - 2 * cells.place[element.cell][d];
      element.place[a] = static_cast<unsigned char>(place);
      if (kCornersAround[place].count == kCorners) element.centre = static_cast<unsigned char>(a);
    }
  }
  find_coarse_points(num_nodes, hexahedra, cells, level);
  for (Hexahedron cell : level.cells) {
    std::sort(cell.begin(), cell.end());
    if (std::adjacent_find(cell.begin(), cell.end()) != cell.end()) return std::nullopt;
  }
  if (!are_connected(across, cells, level.cells)) return std::nullopt;
  level.points = find_points(num_nodes, hexahedra, places);
  level.num_points = num_nodes;
  return level;
}

}  // namespace

Charts::Charts(const HexMesh& initial) {
  std::optional<Level> next = find_level(initial.num_nodes(), initial.hexahedra(), initial.neighbours());
  while (next) {
    const Level& level = levels.emplace_back(std::move(*next));
    next = find_level(level.num_coarse_points, level.cells, neighbours_across_faces(level.cells));
  }
}

}  // namespace hexaplast
