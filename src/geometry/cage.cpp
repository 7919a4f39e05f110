// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/cage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <utility>

#include "base/disjoint_sets.hpp"
#include "geometry/grid_cells.hpp"
#include "hexaplast/base/error.hpp"
#include "mesh/selection.hpp"

namespace hexaplast {
namespace {

constexpr double kSameCorner = 1e-9;   // of the extent: corners this close are one that was written twice
constexpr double kTouch = 1e-9;        // of a cell's size: a surface this near to a cell touches it
constexpr std::size_t kMaxLooks = 16;  // at cells of a region
constexpr double kWinds = 0.75;        // of a full turn, from which a surface with a hole is meant to be closed

/// What a surface makes of a cell.
enum class CageCell : unsigned char {
  kEnclosed,  ///< the surface keeps it apart from the border of the grid
  kTouched,   ///< the surface passes through it
  kOutside
};

/// The cells of a grid, and what is known of each: enclosed, until they are touched or reached.
class LabelledCells {
 public:
  explicit LabelledCells(const CageGrid& grid)
      : grid_(grid), width_((grid.max - grid.min).cwiseQuotient(Vec3(grid.cells[0], grid.cells[1], grid.cells[2]))) {
    kind_.assign(static_cast<std::size_t>(grid.cells[0]) * grid.cells[1] * grid.cells[2], CageCell::kEnclosed);
  }

  CageCell& kind(const GridCell& c) { return kind_[index(c)]; }
  CageCell kind(const GridCell& c) const { return kind_[index(c)]; }
  std::vector<CageCell> take() { return std::move(kind_); }
  const Vec3& width() const { return width_; }
  bool contains(const GridCell& c) const {
    for (int d = 0; d < 3; ++d)
      if (c[d] < 0 || c[d] >= grid_.cells[d]) return false;
    return true;
  }

  /// The cell of a point, or the one next to it where it lies outside.
  GridCell cell_at(const Vec3& point) const {
    GridCell c;
    for (int d = 0; d < 3; ++d)
      c[d] = static_cast<int>(std::clamp(std::floor((point[d] - grid_.min[d]) / width_[d]), 0., grid_.cells[d] - 1.));
    return c;
  }
  Vec3 centre(const GridCell& c) const {
    return grid_.min + width_.cwiseProduct(Vec3(c[0] + 0.5, c[1] + 0.5, c[2] + 0.5));
  }

  /// In the order of the grid: x fastest.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for_each_in({0, 0, 0}, {grid_.cells[0] - 1, grid_.cells[1] - 1, grid_.cells[2] - 1}, visit);
  }
  template <class Visit>
  static void for_each_in(const GridCell& min, const GridCell& max, const Visit& visit) {
    for (int k = min[2]; k <= max[2]; ++k)
      for (int j = min[1]; j <= max[1]; ++j)
        for (int i = min[0]; i <= max[0]; ++i) visit(GridCell{i, j, k});
  }

  /// The six cells across the faces of one, where the grid has them.
  template <class Visit>
  void for_each_neighbour(const GridCell& c, const Visit& visit) const {
    for (int d = 0; d < 3; ++d)
      for (const int step : {-1, 1}) {
        GridCell other = c;
        other[d] += step;
        if (contains(other)) visit(other);
      }
  }

 private:
  std::size_t index(const GridCell& c) const {
    return static_cast<std::size_t>(c[0]) +
           static_cast<std::size_t>(grid_.cells[0]) * (c[1] + static_cast<std::size_t>(grid_.cells[1]) * c[2]);
  }

  CageGrid grid_;
  Vec3 width_;
  std::vector<CageCell> kind_;
};

/// Whether a triangle and the box |p| <= half have a point in common: none of the thirteen axes that can separate the
/// two does. Corners are relative to the centre of the box.
bool touches(const std::array<Vec3, 3>& corners, const Vec3& half) {
  const auto separates = [&](const Vec3& axis) {
    const double a = axis.dot(corners[0]), b = axis.dot(corners[1]), c = axis.dot(corners[2]);
    const double reach = half.dot(axis.cwiseAbs());
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  for (int d = 0; d < 3; ++d)
    if (separates(Vec3::Unit(d))) return false;
  const std::array<Vec3, 3> edges{corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]};
  if (separates(edges[0].cross(edges[1]))) return false;
  for (const Vec3& edge : edges)
    for (int d = 0; d < 3; ++d)
      if (separates(edge.cross(Vec3::Unit(d)))) return false;
  return true;
}

void mark_touched(const std::array<Vec3, 3>& corners, LabelledCells& cells) {
  const Vec3 half = (0.5 + kTouch) * cells.width();
  const Vec3 min = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]),
             max = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]), reach = kTouch * cells.width();
  LabelledCells::for_each_in(cells.cell_at(min - reach), cells.cell_at(max + reach), [&](const GridCell& c) {
    if (cells.kind(c) == CageCell::kTouched) return;
    const Vec3 centre = cells.centre(c);
    if (touches({corners[0] - centre, corners[1] - centre, corners[2] - centre}, half))
      cells.kind(c) = CageCell::kTouched;
  });
}

/// From the cells at the border of the grid through all that the surface does not touch.
void mark_outside(const CageGrid& grid, LabelledCells& cells) {
  std::vector<GridCell> waiting;
  const auto reach = [&](const GridCell& c) {
    if (cells.kind(c) != CageCell::kEnclosed) return;
    cells.kind(c) = CageCell::kOutside;
    waiting.push_back(c);
  };
  cells.for_each([&](const GridCell& c) {
    for (int d = 0; d < 3; ++d)
      if (c[d] == 0 || c[d] == grid.cells[d] - 1) return reach(c);
  });
  while (!waiting.empty()) {
    const GridCell c = waiting.back();
    waiting.pop_back();
    cells.for_each_neighbour(c, reach);
  }
}

/// How the faces of a surface meet. A face that is there again, in whatever order of its corners, counts once.
struct SurfaceEdges {
  std::vector<Triangle> faces;
  std::vector<Edge> open;   // that one face alone has
  bool is_oriented = true;  // whether two faces run through their common edge in opposite directions
};

/// For each node the one that stands for all in its place: files may hold a vertex more than once.
std::vector<int> places_of(ConstPoints x, std::span<const Triangle> faces) {
  std::vector<int> corners;
  for (const Triangle& face : faces) corners.insert(corners.end(), face.begin(), face.end());
  std::ranges::sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  Eigen::AlignedBox3d box;
  for (const int node : corners) box.extend(x.row(node).transpose());
  const double reach = kSameCorner * box.diagonal().norm();
  // along a direction that no mesh is aligned with, few others are as near as those in the same place
  const Eigen::VectorXd along = x * Vec3(0.5377, 0.6811, 0.4969).normalized();
  std::ranges::sort(corners, {}, [&](int node) { return std::pair(along[node], node); });
  DisjointSets places(static_cast<int>(x.rows()));
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size() && along[corners[j]] - along[corners[i]] <= reach; ++j)
      if ((x.row(corners[i]) - x.row(corners[j])).norm() <= reach) places.join(corners[i], corners[j]);
  std::vector<int> found(static_cast<std::size_t>(x.rows()));
  for (const int node : corners) found[node] = places.root(node);
  return found;
}

SurfaceEdges edges_of_surface(ConstPoints x, std::span<const Triangle> faces) {
  const std::vector<int> place = places_of(x, faces);
  SurfaceEdges surface;
  std::vector<std::pair<Triangle, std::size_t>> corners;  // places in ascending order, and whose they are
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Triangle found = {place[faces[f][0]], place[faces[f][1]], place[faces[f][2]]};
    std::ranges::sort(found);
    corners.emplace_back(found, f);
  }
  std::ranges::sort(corners);
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (i == 0 || corners[i].first != corners[i - 1].first) surface.faces.push_back(faces[corners[i].second]);

  std::vector<std::pair<Edge, bool>> sides;  // with whether the face runs from the lesser corner to the greater
  for (const Triangle& face : surface.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = place[face[k]], b = place[face[(k + 1) % 3]];
      if (a != b) sides.emplace_back(sorted(Edge{a, b}), a < b);
    }
  std::ranges::sort(sides);
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].first == sides[first].first) ++end;
    if (end - first == 1) surface.open.push_back(sides[first].first);
    if (end - first == 2 && sides[first] == sides[first + 1]) surface.is_oriented = false;
  }
  return surface;
}

/// LabelledCells that the outside reaches only through holes of the surface, and around which it winds nearly: a hole
/// is meant to be closed where the cage would be hollow, and a sheet or a bowl is open. Around what a surface winds
/// whose faces are not oriented alike is not known: all such cells count. cells: reached from outside; closed: the same
/// before, touched alone.
std::size_t count_leaks(ConstPoints x, const SurfaceEdges& edges, const CageGrid& grid, const LabelledCells& cells,
                        LabelledCells closed) {
  // a fan over each hole
  std::unordered_map<int, int> number;  // of the nodes of open edges
  for (const Edge& edge : edges.open)
    for (const int node : edge) number.try_emplace(node, static_cast<int>(number.size()));
  DisjointSets holes(static_cast<int>(number.size()));
  for (const Edge& edge : edges.open) holes.join(number[edge[0]], number[edge[1]]);
  const auto at = [&](int node) -> Vec3 { return x.row(node).transpose(); };
  const auto hole_of = [&](const Edge& edge) { return holes.root(number[edge[0]]); };
  std::unordered_map<int, std::pair<Vec3, double>> sum;  // of both ends, and their count
  for (const Edge& edge : edges.open) {
    auto& [ends, count] = sum.try_emplace(hole_of(edge), Vec3::Zero(), 0).first->second;
    ends += at(edge[0]) + at(edge[1]);
    count += 2;
  }
  for (const Edge& edge : edges.open) {
    const auto& [ends, count] = sum.at(hole_of(edge));
    mark_touched({at(edge[0]), at(edge[1]), ends / count}, closed);
  }
  mark_outside(grid, closed);

  // each region that the fans keep from the outside, by some of its cells
  std::size_t num_leaks = 0;
  std::vector<GridCell> region;
  cells.for_each([&](const GridCell& start) {
    const auto reach = [&](const GridCell& c) {
      if (closed.kind(c) != CageCell::kEnclosed || cells.kind(c) != CageCell::kOutside) return;
      closed.kind(c) = CageCell::kOutside;
      region.push_back(c);
    };
    region.clear();
    reach(start);
    for (std::size_t k = 0; k < region.size(); ++k) closed.for_each_neighbour(GridCell(region[k]), reach);
    if (region.empty()) return;
    double angle = 0;  // mean of some cells: at one that is near to a sheet it is more than half a turn
    const std::size_t num_looks = std::min(region.size(), kMaxLooks);
    for (std::size_t k = 0; k < num_looks; ++k) {
      const Vec3 inside = cells.centre(region[(2 * k + 1) * region.size() / (2 * num_looks)]);
      for (const auto& [a, b, c] : edges.faces)
        angle += solid_angle(at(a) - inside, at(b) - inside, at(c) - inside) / static_cast<double>(num_looks);
    }
    if (!edges.is_oriented || std::abs(angle) > kWinds * 4 * std::numbers::pi) num_leaks += region.size();
  });
  return num_leaks;
}

/// Nodes of the kept cells, numbered by x, then y, then z.
HexMesh mesh_of(const std::vector<GridCell>& kept, const CageGrid& grid) {
  GridHexahedra found = grid_hexahedra(kept, grid.cells);
  const Vec3 spacing = (grid.max - grid.min).cwiseQuotient(Vec3(grid.cells[0], grid.cells[1], grid.cells[2]));
  PointArray positions(static_cast<Eigen::Index>(found.nodes.size()), 3);
  for (std::size_t n = 0; n < found.nodes.size(); ++n) {
    const auto& [i, j, k] = found.nodes[n];
    positions.row(static_cast<Eigen::Index>(n)) = (grid.min + Vec3(i, j, k).cwiseProduct(spacing)).transpose();
  }
  return HexMesh(std::move(positions), std::move(found.hexahedra));
}

void require_grid(const CageGrid& grid) {
  double count = 1;
  for (int d = 0; d < 3; ++d) {
    if (grid.cells[d] < 1)
      throw InputError(fmt::format("a cage of {} cells in direction {}: at least 1 needed", grid.cells[d], d));
    if (!(grid.min[d] < grid.max[d]))
      throw InputError(
          fmt::format("a cage from {} to {} in direction {}: the box is empty", grid.min[d], grid.max[d], d));
    count *= grid.cells[d];
  }
  if (count > kMaxCageCells)
    throw InputError(fmt::format("a cage cut out of {} x {} x {} cells: at most {:.10g} are possible", grid.cells[0],
                                 grid.cells[1], grid.cells[2], kMaxCageCells));
}

}  // namespace

Eigen::AlignedBox3d box_around(ConstPoints points) {
  const Vec3 min = points.colwise().minCoeff().transpose(), max = points.colwise().maxCoeff().transpose();
  const Vec3 margin = kCageMargin * (max - min);
  return {Vec3(min - margin), Vec3(max + margin)};
}

CageGrid cubes_around(ConstPoints points, int cells) {
  if (cells < 1) throw InputError(fmt::format("a cage of {} cells: at least 1 needed", cells));
  const Vec3 extent = points.rows() > 0 ? box_around(points).sizes().eval() : Vec3::Zero().eval();
  const double longest = extent.maxCoeff();
  if (!(longest > 0 && std::isfinite(longest)))
    throw InputError("the points have no extent around which cells could be laid");

  // as many as cover the box in each direction, the box in their middle
  const double width = longest / cells;
  CageGrid grid;
  Vec3 size;
  for (int d = 0; d < 3; ++d) {
    grid.cells[d] = std::clamp(static_cast<int>(std::ceil(extent[d] / width * (1 - kTouch))), 1, cells);
    size[d] = grid.cells[d] * width;
  }
  const Vec3 centre = box_around(points).center();
  grid.min = centre - size / 2;
  grid.max = centre + size / 2;
  return grid;
}

namespace {

/// What the surface makes of the cells of the grid, x fastest.
std::vector<CageCell> cells_around(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads,
                                   const CageGrid& grid) {
  if (triangles.empty() && quads.empty()) throw InputError("the surface has neither triangles nor quads");
  require_grid(grid);
  LabelledCells cells(grid);
  const Eigen::AlignedBox3d box(Vec3(grid.min - kTouch * cells.width()), Vec3(grid.max + kTouch * cells.width()));
  const auto corner = [&](int node) -> Vec3 {
    if (node < 0 || node >= x.rows())
      throw InputError(fmt::format("a face of the surface has node {}: must lie in [0, {})", node, x.rows()));
    const Vec3 p = x.row(node).transpose();
    if (!box.contains(p))  // nor does it contain what is not a number
      throw InputError(fmt::format(
          "node {} of the surface, at ({:.6g}, {:.6g}, {:.6g}), lies outside the box from ({:.6g}, {:.6g}, {:.6g}) to "
          "({:.6g}, {:.6g}, {:.6g})",
          node, p[0], p[1], p[2], grid.min[0], grid.min[1], grid.min[2], grid.max[0], grid.max[1], grid.max[2]));
    return p;
  };
  std::vector<Triangle> faces(triangles.begin(), triangles.end());
  for (const Quad& face : quads) {
    faces.push_back({face[0], face[1], face[2]});
    faces.push_back({face[0], face[2], face[3]});
  }
  for (const auto& [a, b, c] : faces) mark_touched({corner(a), corner(b), corner(c)}, cells);
  const SurfaceEdges edges = edges_of_surface(x, faces);
  std::optional<LabelledCells> touched;
  if (!edges.open.empty()) touched = cells;
  mark_outside(grid, cells);
  if (edges.open.empty()) return cells.take();

  const std::size_t num_leaks = count_leaks(x, edges, grid, cells, std::move(*touched));
  if (num_leaks > 0) {
    const Vec3 a = corner(edges.open[0][0]), b = corner(edges.open[0][1]);
    throw InputError(fmt::format(
        "the surface is open, and {} cells inside would stay empty: {} edges belong to one face alone, the first from "
        "({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}); close the holes, or use "
        "larger cells; where the wall alone is meant, make layers on the surface (offset)",
        num_leaks, edges.open.size(), a[0], a[1], a[2], b[0], b[1], b[2]));
  }
  return cells.take();
}

}  // namespace

Cage cage_around(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads,
                 const CageGrid& grid) {
  const std::vector<CageCell> cells = cells_around(x, triangles, quads, grid);
  std::vector<GridCell> chosen;
  const auto choose = [&](CageCell kind) {
    for (std::size_t w = 0; w < cells.size(); ++w)
      if (cells[w] == kind) {
        const std::size_t row = w / grid.cells[0];
        chosen.push_back({static_cast<int>(w % grid.cells[0]), static_cast<int>(row % grid.cells[1]),
                          static_cast<int>(row / grid.cells[1])});
      }
  };
  choose(CageCell::kTouched);
  const int num_touched = static_cast<int>(chosen.size());
  choose(CageCell::kEnclosed);

  Cage cage{.mesh = mesh_of(chosen, grid), .num_touched = num_touched};
  const GridConnection connection = connection_of(cage.mesh);
  cage.num_parts = connection.num_parts;
  cage.num_hinges = connection.num_hinges;
  return cage;
}

}  // namespace hexaplast
