// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layout/coarsening.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.hpp"

namespace hexaplast {

namespace {

/// The elements of a level as they are now.
struct Elements {
  const Charts::Level& charts;
  int num_nodes;
  std::span<const Hexahedron> nodes;
  std::span<const int> chart_element;

  int count() const { return static_cast<int>(nodes.size()); }
  int in_charts(int e) const { return chart_element.empty() ? e : chart_element[e]; }
  const Charts::Element& operator[](int e) const { return charts.elements[in_charts(e)]; }
};

struct CoarseCells {
  std::vector<int> of_element;  // -1: in none
  std::vector<int> chart_cell;
  std::vector<std::array<int, kCorners>> children;

  int count() const { return static_cast<int>(chart_cell.size()); }
};

/// A child that a slit divides, though not its cell, is there twice; then so is the cell, with the same corners.
CoarseCells find_coarse_cells(const Elements& elements) {
  CoarseCells cells;
  cells.of_element.resize(elements.count());
  std::vector<int> latest(elements.charts.cells.size(), -1);  // of the cells with one chart_cell
  std::vector<int> before, centre;                            // per cell: the one before it; the node in its middle
  for (int e = 0; e < elements.count(); ++e) {
    const Charts::Element& element = elements[e];
    const int middle = elements.nodes[e][element.centre];
    int cell = latest[element.cell];
    while (cell >= 0 && (centre[cell] != middle || cells.children[cell][element.slot] >= 0)) cell = before[cell];
    if (cell < 0) {
      cell = cells.count();
      before.push_back(std::exchange(latest[element.cell], cell));
      centre.push_back(middle);
      cells.chart_cell.push_back(element.cell);
      cells.children.emplace_back().fill(-1);
    }
    cells.of_element[e] = cell;
    cells.children[cell][element.slot] = e;
  }
  return cells;
}

bool gains(int num_elements, int num_cells) { return num_elements >= kMinGain * num_cells; }

/// Pieces for which cells gain nothing lose them.
void remove_crumbs(const Elements& elements, CoarseCells& cells) {
  DisjointSets pieces(elements.num_nodes);
  for (const Hexahedron& nodes : elements.nodes)
    for (const int node : nodes) pieces.join(nodes[0], node);
  const auto piece_of = [&](int e) { return pieces.root(elements.nodes[e][0]); };
  std::vector<int> num_elements(elements.num_nodes, 0), num_cells = num_elements, first(cells.count(), -1);
  for (int e = elements.count() - 1; e >= 0; --e) {
    ++num_elements[piece_of(e)];
    first[cells.of_element[e]] = e;
  }
  for (const int e : first) ++num_cells[piece_of(e)];

  CoarseCells left;
  std::vector<int> number(cells.count(), -1);
  for (int c = 0; c < cells.count(); ++c) {
    const int piece = piece_of(first[c]);
    if (!gains(num_elements[piece], num_cells[piece])) continue;
    number[c] = left.count();
    left.chart_cell.push_back(cells.chart_cell[c]);
    left.children.push_back(cells.children[c]);
  }
  for (const int cell : cells.of_element) left.of_element.push_back(number[cell]);
  cells = std::move(left);
}

/// Per coarse point: whether nodes have split at the children of cells around it.
std::vector<char> find_split(const Elements& elements) {
  std::vector<int> node_at(elements.charts.num_points, -1);
  std::vector<char> is_split(elements.charts.num_points, 0), is_around(elements.charts.num_coarse_points, 0);
  const auto for_each_corner = [&](const auto& visit) {
    for (int e = 0; e < elements.count(); ++e) {
      const Hexahedron& points = elements.charts.points[elements.in_charts(e)];
      for (int a = 0; a < kCorners; ++a) visit(e, points[a], elements.nodes[e][a]);
    }
  };
  bool is_any = false;
  for_each_corner([&](int, int point, int node) {
    if (node_at[point] < 0) node_at[point] = node;
    if (node_at[point] == node) return;
    is_split[point] = 1;
    is_any = true;
  });
  if (is_any)
    for_each_corner([&](int e, int point, int) {
      if (!is_split[point]) return;
      for (const int coarse : elements.charts.cells[elements[e].cell]) is_around[coarse] = 1;
    });
  return is_around;
}

/// Numbers the coarse nodes in the order of the cells.
void find_nodes(const Elements& elements, const CoarseCells& cells, Coarsening& out) {
  const std::vector<char> is_split = find_split(elements);
  DisjointSets sets;
  std::vector<int> node_at(elements.charts.num_coarse_points, -1);  // where nothing has split
  std::vector<char> has_split(cells.count(), 0);
  out.cells.resize(cells.count());
  for (int c = 0; c < cells.count(); ++c)
    for (int a = 0; a < kCorners; ++a) {
      const int point = elements.charts.cells[cells.chart_cell[c]][a];
      int &node = out.cells[c][a], &there = node_at[point];
      if (is_split[point] || there < 0) {
        node = sets.num_members();
        sets.add();
      }
      if (is_split[point])
        has_split[c] = 1;
      else
        node = there < 0 ? there = node : there;
    }

  // what cells around a node have at one point is one
  struct Entry {
    int point, node, next;
  };
  std::vector<Entry> entries;
  std::vector<int> first(elements.num_nodes, -1);  // of the entries of a node
  for (int e = 0; e < elements.count(); ++e) {
    const int cell = cells.of_element[e];
    if (cell < 0 || !has_split[cell]) continue;
    for (int a = 0; a < kCorners; ++a) {
      const CornersAround& around = kCornersAround[elements[e].place[a]];
      int& first_here = first[elements.nodes[e][a]];
      for (int k = 0; k < around.count; ++k) {
        const int corner = around.corner[k], point = elements.charts.cells[cells.chart_cell[cell]][corner];
        if (!is_split[point]) continue;
        int entry = first_here;
        while (entry >= 0 && entries[entry].point != point) entry = entries[entry].next;
        if (entry >= 0) {
          sets.join(entries[entry].node, out.cells[cell][corner]);
        } else {
          entries.push_back({point, out.cells[cell][corner], first_here});
          first_here = static_cast<int>(entries.size()) - 1;
        }
      }
    }
  }

  std::vector<int> number(static_cast<std::size_t>(sets.num_members()), -1);
  for (Hexahedron& cell : out.cells)
    for (int& node : cell) {
      int& at = number[sets.root(node)];
      if (at < 0) at = out.num_nodes++;
      node = at;
    }
}

/// Each fine node by the cell in which it needs the fewest corners.
NodalMap trilinear(const Elements& elements, const CoarseCells& cells, const std::vector<Hexahedron>& cell_corners) {
  struct Place {
    int cell = -1, in_cell = 0, needed = kCorners + 1;
  };
  std::vector<Place> best(static_cast<std::size_t>(elements.num_nodes));
  for (int e = 0; e < elements.count(); ++e) {
    if (cells.of_element[e] < 0) continue;
    for (int a = 0; a < kCorners; ++a) {
      const int in_cell = elements[e].place[a], needed = kCornersAround[in_cell].count;
      Place& place = best[elements.nodes[e][a]];
      if (needed < place.needed) place = {cells.of_element[e], in_cell, needed};
    }
  }
  NodalMap map;
  map.first.reserve(best.size() + 1);
  map.first.push_back(0);
  for (const Place& place : best) {
    for (int k = 0; place.cell >= 0 && k < place.needed; ++k) {
      map.column.push_back(cell_corners[place.cell][kCornersAround[place.in_cell].corner[k]]);
      map.weight.push_back(1.0f / static_cast<float>(place.needed));
    }
    map.first.push_back(static_cast<int>(map.column.size()));
  }
  return map;
}

/// Per coarse node: the fine node there, or -1.
std::vector<int> find_fine_nodes(const Elements& elements, const CoarseCells& cells, const Coarsening& coarse) {
  std::vector<int> fine_node(coarse.num_nodes, -1);
  for (int e = 0; e < elements.count(); ++e) {
    const Charts::Element& element = elements[e];
    if (cells.of_element[e] < 0) continue;
    for (int a = 0; a < kCorners; ++a) {
      if (kCornersAround[element.place[a]].count > 1) continue;
      int& there = fine_node[coarse.cells[cells.of_element[e]][element.slot]];
      there = std::max(there, elements.nodes[e][a]);
    }
  }
  return fine_node;
}

/// Each coarse node at its fine node, or by the affine extension of the child that lies nearest to the corner.
NodalMap affine(const Elements& elements, const Coarsening& coarse) {
  struct Nearest {
    int child = -1, corner = -1, slot = -1, steps = 4;
  };
  std::vector<Nearest> nearest(coarse.fine_node.size());
  for (std::size_t c = 0; c < coarse.cells.size(); ++c)
    for (int a = 0; a < kCorners; ++a) {
      const int node = coarse.cells[c][a];
      if (coarse.fine_node[node] >= 0) continue;
      for (int b = 0; b < kCorners; ++b) {
        if (coarse.children[c][b] < 0) continue;
        int steps = 0;
        for (int d = 0; d < 3; ++d) steps += kCornerSign[a][d] != kCornerSign[b][d];
        if (steps < nearest[node].steps) nearest[node] = {coarse.children[c][b], a, b, steps};
      }
    }
  NodalMap map;
  map.first.push_back(0);
  for (std::size_t node = 0; node < coarse.fine_node.size(); ++node) {
    if (coarse.fine_node[node] >= 0) {
      map.column.push_back(coarse.fine_node[node]);
      map.weight.push_back(1);
    } else {
      // s: the corner in the child's reference cube; x = mean of x_b (1 + s . s_b)
      const auto& [child, corner, slot, steps] = nearest[node];
      for (int b = 0; b < kCorners; ++b) {
        const int place = elements[child].place[b];
        const std::array<int, 3> at = {place % 3, place / 3 % 3, place / 9};
        double weight = 1;
        for (int d = 0; d < 3; ++d) {
          const int low = kCornerSign[slot][d] > 0, target = kCornerSign[corner][d] + 1;
          weight += (2.0 * (target - low) - 1) * (2.0 * (at[d] - low) - 1);
        }
        map.column.push_back(elements.nodes[child][b]);
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

std::optional<Coarsening> coarsen(const Charts::Level& charts, int num_nodes, std::span<const Hexahedron> hexahedra,
                                  std::span<const int> chart_element) {
  const Elements elements{charts, num_nodes, hexahedra, chart_element};
  CoarseCells cells = find_coarse_cells(elements);
  if (!gains(elements.count(), cells.count())) remove_crumbs(elements, cells);
  if (cells.count() == 0) return std::nullopt;
  Coarsening out;
  find_nodes(elements, cells, out);
  out.fine_node = find_fine_nodes(elements, cells, out);
  out.children = std::move(cells.children);
  out.chart_cell = std::move(cells.chart_cell);
  out.prolongation = trilinear(elements, cells, out.cells);
  out.placement = affine(elements, out);
  return out;
}

}  // namespace hexaplast
