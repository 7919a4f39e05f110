// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/coarsened_cage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "mesh/copies.hpp"

namespace hexaplast {
namespace {

using Cell = std::array<int, 3>;  // ordered by x, then y, then z

constexpr int kMaxLevels = 10;

/// Matter in a cell that deforms together.
struct Part {
  Cell cell{};
  double fill = 0;
  std::array<std::vector<int>, 3> below{}, above{};  // parts of the neighbouring cells along x, y and z
};

void add_once(std::vector<int>& parts, int part) {
  if (std::ranges::find(parts, part) == parts.end()) parts.push_back(part);
}

/// Where the edges of a surface pass through faces of a grid. As in SOFA, a face of the surface has the edges from each
/// corner to the next, without that from the last to the first, and an edge reaches as far beyond its first corner as
/// it is long.
class Crossings {
 public:
  Crossings(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads) {
    for (const Triangle& face : triangles) add<3>(x, face);
    for (const Quad& face : quads) add<4>(x, face);
  }

  /// Whether one passes through the rectangle from `corner` with the given size, which is 0 along `d` alone.
  bool pass(const Vec3& corner, const Vec3& size, int d) const {
    return std::ranges::any_of(edges_, [&](const auto& edge) {
      const auto& [from, to] = edge;
      if (from[d] == to[d]) return false;
      const double fraction = (corner[d] - from[d]) / (to[d] - from[d]);
      if (std::abs(fraction) > 1) return false;
      const Vec3 point = from + fraction * (to - from);
      for (const int other : {(d + 1) % 3, (d + 2) % 3})
        if (point[other] < corner[other] || point[other] > corner[other] + size[other]) return false;
      return true;
    });
  }

 private:
  template <std::size_t N>
  void add(ConstPoints x, const std::array<int, N>& face) {
    for (std::size_t i = 0; i + 1 < N; ++i)
      edges_.push_back({x.row(face[i]).transpose(), x.row(face[i + 1]).transpose()});
  }

  std::vector<std::pair<Vec3, Vec3>> edges_;
};

/// The kept cells of the finest grid. crossings: where touched cells meet; null: at all their faces.
std::vector<Part> parts_of(const Cage& cage, const CageGrid& grid, std::span<const double> fill,
                           const Crossings* crossings) {
  const Vec3 spacing = (grid.max - grid.min).cwiseQuotient(Vec3(grid.cells[0], grid.cells[1], grid.cells[2]));
  std::vector<Part> parts(cage.mesh.hexahedra().size());
  std::map<Cell, int> part_at;
  for (std::size_t e = 0; e < parts.size(); ++e) {
    const Vec3 corner = cage.mesh.positions().row(cage.mesh.hexahedra()[e][0]).transpose();
    for (int d = 0; d < 3; ++d)
      parts[e].cell[d] = static_cast<int>(std::lround((corner[d] - grid.min[d]) / spacing[d]));
    parts[e].fill = fill[e];
    part_at[parts[e].cell] = static_cast<int>(e);
  }
  for (const auto& [cell, part] : part_at)
    for (int d = 0; d < 3; ++d) {
      Cell neighbour = cell;
      --neighbour[d];
      const auto found = part_at.find(neighbour);
      if (found == part_at.end()) continue;
      if (crossings && std::max(part, found->second) < cage.num_touched) {
        const Vec3 corner = cage.mesh.positions().row(cage.mesh.hexahedra()[part][0]).transpose();
        if (!crossings->pass(corner, spacing, d)) continue;
      }
      parts[part].below[d].push_back(found->second);
      parts[found->second].above[d].push_back(part);
    }
  return parts;
}

/// Group of each of some parts: those that are connected among themselves, numbered as they are first met.
std::vector<int> connected_groups(const std::vector<Part>& parts, const std::vector<int>& some) {
  std::vector<int> group(some.size(), -1);
  int num_groups = 0;
  for (std::size_t first = 0; first < some.size(); ++first) {
    if (group[first] >= 0) continue;
    std::vector<std::size_t> open = {first};
    group[first] = num_groups;
    while (!open.empty()) {
      const Part& part = parts[some[open.back()]];
      open.pop_back();
      for (const auto* side : {&part.below, &part.above})
        for (const std::vector<int>& neighbours : *side)
          for (const int neighbour : neighbours) {
            const auto place = static_cast<std::size_t>(std::ranges::find(some, neighbour) - some.begin());
            if (place == some.size() || group[place] >= 0) continue;
            group[place] = num_groups;
            open.push_back(place);
          }
    }
    ++num_groups;
  }
  return group;
}

/// Twice as coarse.
std::vector<Part> coarsened(const std::vector<Part>& fine, SeparateParts separate) {
  std::map<Cell, std::array<std::vector<int>, 8>> children;
  for (std::size_t p = 0; p < fine.size(); ++p) {
    const Cell& cell = fine[p].cell;
    children[{cell[0] / 2, cell[1] / 2, cell[2] / 2}][cell[0] % 2 + 2 * (cell[1] % 2) + 4 * (cell[2] % 2)].push_back(
        static_cast<int>(p));
  }
  std::vector<Part> coarse;
  std::vector<int> parent(fine.size());
  for (const auto& [cell, by_place] : children) {
    std::vector<int> all;
    for (const std::vector<int>& here : by_place) all.insert(all.end(), here.begin(), here.end());
    const std::vector<int> group =
        separate == SeparateParts::kOwnHexahedra ? connected_groups(fine, all) : std::vector<int>(all.size(), 0);
    const std::size_t first = coarse.size();
    coarse.resize(first + static_cast<std::size_t>(std::ranges::max(group)) + 1, Part{.cell = cell});
    for (std::size_t i = 0; i < all.size(); ++i) {
      parent[all[i]] = static_cast<int>(first) + group[i];
      coarse[parent[all[i]]].fill += fine[all[i]].fill / 8;
    }
  }
  for (std::size_t p = 0; p < fine.size(); ++p)
    for (int d = 0; d < 3; ++d)
      for (const int q : fine[p].below[d]) {
        const int upper = parent[p], lower = parent[q];
        if (coarse[upper].cell == coarse[lower].cell) continue;
        add_once(coarse[upper].below[d], lower);
        add_once(coarse[lower].above[d], upper);
      }
  return coarse;
}

/// Corners of a hexahedron at its lower face along x, y and z, and those of the one below that they meet.
constexpr std::array<std::array<std::pair<int, int>, 4>, 3> kMeeting{
    {{{{0, 1}, {4, 5}, {7, 6}, {3, 2}}}, {{{0, 3}, {4, 7}, {5, 6}, {1, 2}}}, {{{0, 4}, {1, 5}, {2, 6}, {3, 7}}}}};
/// Where the corners of a cell lie from its lowest one.
constexpr std::array<Cell, 8> kPlaces{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

/// Nodes of hexahedra that begin apart: those that are joined become the one that is joined to.
class Nodes {
 public:
  explicit Nodes(std::size_t count) : joined_to_(count) { std::iota(joined_to_.begin(), joined_to_.end(), 0); }
  int of(int node) const {
    while (joined_to_[node] != node) node = joined_to_[node];
    return node;
  }
  void join(int node, int to) { joined_to_[of(node)] = of(to); }

 private:
  std::vector<int> joined_to_;
};

/// Parts that have all their nodes in common, as their branches join on every side, become one.
HexMesh mesh_of(std::vector<Part>& parts, const Vec3& min, const Vec3& spacing, SeparateParts separate) {
  const auto place_of = [&](std::size_t e, int a) {
    Cell place = parts[e].cell;
    for (int d = 0; d < 3; ++d) place[d] += kPlaces[a][d];
    return place;
  };
  Nodes nodes(8 * parts.size());
  std::map<Cell, std::vector<int>> at;  // nodes in one place
  if (separate == SeparateParts::kOwnHexahedra) {
    for (std::size_t e = 0; e < parts.size(); ++e)
      for (const int d : {2, 1, 0})
        for (const int below : parts[e].below[d])
          for (const auto& [own, other] : kMeeting[d]) nodes.join(static_cast<int>(8 * e) + own, 8 * below + other);
  } else {
    for (std::size_t e = 0; e < parts.size(); ++e)
      for (int a = 0; a < 8; ++a) at[place_of(e, a)].push_back(static_cast<int>(8 * e) + a);
    for (const auto& [place, same] : at)
      for (const int node : same) nodes.join(node, same[0]);
  }

  std::vector<int> number(8 * parts.size(), -1);
  std::vector<Vec3> points;
  const auto add = [&](int node) {
    const int root = nodes.of(node);
    if (number[root] >= 0) return;
    number[root] = static_cast<int>(points.size());
    const Cell place = place_of(static_cast<std::size_t>(root) / 8, root % 8);
    points.push_back(min + Vec3(place[0], place[1], place[2]).cwiseProduct(spacing));
  };
  if (separate == SeparateParts::kOwnHexahedra) {
    for (int node = 0; node < static_cast<int>(number.size()); ++node)
      if (nodes.of(node) == node) add(node);
  } else {
    for (const auto& [place, same] : at) add(same[0]);
  }

  PointArray positions(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t n = 0; n < points.size(); ++n) positions.row(static_cast<Eigen::Index>(n)) = points[n].transpose();
  std::vector<Hexahedron> hexahedra(parts.size());
  for (std::size_t e = 0; e < parts.size(); ++e)
    for (int a = 0; a < 8; ++a) hexahedra[e][a] = number[nodes.of(static_cast<int>(8 * e) + a)];

  const std::vector<int> first = first_copies<Hexahedron>(hexahedra);
  std::vector<std::size_t> place(parts.size());
  std::size_t count = 0;
  for (std::size_t e = 0; e < parts.size(); ++e) {
    if (const auto other = static_cast<std::size_t>(first[e]); other != e) {
      parts[place[other]].fill += parts[e].fill;
      continue;
    }
    place[e] = count;
    hexahedra[count] = hexahedra[e];
    if (count != e) parts[count] = std::move(parts[e]);
    ++count;
  }
  parts.resize(count);
  hexahedra.resize(count);
  return HexMesh(std::move(positions), std::move(hexahedra));
}

}  // namespace

CageGrid finer(CageGrid grid, int levels) {
  if (levels < 0 || levels > kMaxLevels)
    throw InputError(fmt::format("{} levels, must lie in [0, {}]", levels, kMaxLevels));
  double count = 1;
  for (const int cells : grid.cells) count *= std::ldexp(cells, levels);
  if (count > kMaxCageCells)
    throw InputError(fmt::format("{:g} cells of the finest grid, must be at most {:g}", count, kMaxCageCells));
  for (int& cells : grid.cells) cells <<= levels;
  return grid;
}

CoarsenedCage coarsened_cage(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads,
                             const CageGrid& grid, int levels, SeparateParts separate, double touched_fill,
                             CellsMeet meet) {
  const CageGrid fine_grid = finer(grid, levels);
  const Cage fine = cage_around(x, triangles, quads, fine_grid);
  std::vector<double> fill(fine.mesh.hexahedra().size(), 1);
  std::fill_n(fill.begin(), fine.num_touched, touched_fill);
  std::optional<CageCrossings> crossings;
  if (meet == CellsMeet::kWhereCrossed) crossings.emplace(CageCrossings{x, triangles, quads});
  return coarsened_cage(fine, fine_grid, fill, levels, separate, crossings);
}

CoarsenedCage coarsened_cage(const Cage& fine, const CageGrid& fine_grid, std::span<const double> fill, int levels,
                             SeparateParts separate, const std::optional<CageCrossings>& crossings) {
  if (fill.size() != fine.mesh.hexahedra().size())
    throw InputError(fmt::format("{} values for {} hexahedra", fill.size(), fine.mesh.hexahedra().size()));
  CageGrid grid = fine_grid;
  for (int& cells : grid.cells) cells >>= levels;

  std::optional<Crossings> edges;
  if (crossings) edges.emplace(crossings->x, crossings->triangles, crossings->quads);
  std::vector<Part> parts = parts_of(fine, fine_grid, fill, edges ? &*edges : nullptr);
  for (int level = 0; level < levels; ++level) parts = coarsened(parts, separate);
  const Vec3 spacing = (grid.max - grid.min).cwiseQuotient(Vec3(grid.cells[0], grid.cells[1], grid.cells[2]));
  HexMesh mesh = mesh_of(parts, grid.min, spacing, separate);
  std::vector<double> coarse_fill;
  int num_doubled = 0;
  for (std::size_t e = 0; e < parts.size(); ++e) {
    coarse_fill.push_back(parts[e].fill);
    const bool is_doubled =
        (e > 0 && parts[e - 1].cell == parts[e].cell) || (e + 1 < parts.size() && parts[e + 1].cell == parts[e].cell);
    if (is_doubled) ++num_doubled;
  }
  return {std::move(mesh), std::move(coarse_fill), num_doubled};
}

}  // namespace hexaplast
