// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/cage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/grid_cells.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

constexpr double kTouch = 1e-9;  // of a cell's size: a surface this near to a cell touches it

/// The cells of a grid, and what is known of each: enclosed, until they are touched or reached.
class Cells {
 public:
  explicit Cells(const CageGrid& grid)
      : grid_(grid), width_((grid.max - grid.min).cwiseQuotient(Vec3(grid.cells[0], grid.cells[1], grid.cells[2]))) {
    kind_.assign(static_cast<std::size_t>(grid.cells[0]) * grid.cells[1] * grid.cells[2], CageCell::kEnclosed);
  }

  CageCell& kind(const GridCell& c) { return kind_[index(c)]; }
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

void mark_touched(const std::array<Vec3, 3>& corners, Cells& cells) {
  const Vec3 half = (0.5 + kTouch) * cells.width();
  const Vec3 min = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]),
             max = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]), reach = kTouch * cells.width();
  Cells::for_each_in(cells.cell_at(min - reach), cells.cell_at(max + reach), [&](const GridCell& c) {
    if (cells.kind(c) == CageCell::kTouched) return;
    const Vec3 centre = cells.centre(c);
    if (touches({corners[0] - centre, corners[1] - centre, corners[2] - centre}, half))
      cells.kind(c) = CageCell::kTouched;
  });
}

/// From the cells at the border of the grid through all that the surface does not touch.
void mark_outside(const CageGrid& grid, Cells& cells) {
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

std::vector<CageCell> cells_around(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads,
                                   const CageGrid& grid) {
  if (triangles.empty() && quads.empty()) throw InputError("the surface has neither triangles nor quads");
  require_grid(grid);
  Cells cells(grid);
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
  const auto mark = [&](int a, int b, int c) { mark_touched({corner(a), corner(b), corner(c)}, cells); };
  for (const Triangle& face : triangles) mark(face[0], face[1], face[2]);
  for (const Quad& face : quads) {
    mark(face[0], face[1], face[2]);
    mark(face[0], face[2], face[3]);
  }
  mark_outside(grid, cells);
  return cells.take();
}

Cage cage_of(std::span<const CageCell> cells, const CageGrid& grid, CageCells kept) {
  require_grid(grid);
  const std::size_t num_cells = static_cast<std::size_t>(grid.cells[0]) * grid.cells[1] * grid.cells[2];
  if (cells.size() != num_cells) throw InputError(fmt::format("{} cells for a grid of {}", cells.size(), num_cells));
  std::vector<GridCell> chosen;
  std::vector<std::size_t> places;
  const auto choose = [&](CageCell kind) {
    for (std::size_t w = 0; w < cells.size(); ++w)
      if (cells[w] == kind) {
        places.push_back(w);
        const std::size_t row = w / grid.cells[0];
        chosen.push_back({static_cast<int>(w % grid.cells[0]), static_cast<int>(row % grid.cells[1]),
                          static_cast<int>(row / grid.cells[1])});
      }
  };
  if (kept == CageCells::kTouchedOrEnclosed) choose(CageCell::kTouched);
  const int num_touched = static_cast<int>(chosen.size());
  choose(CageCell::kEnclosed);
  if (chosen.empty()) throw InputError("the surface encloses no cell: it is open, or the cells are too large");

  Cage cage{.mesh = mesh_of(chosen, grid), .cells = std::move(places), .num_touched = num_touched};
  const GridConnection connection = connection_of(cage.mesh);
  cage.num_parts = connection.num_parts;
  cage.num_hinges = connection.num_hinges;
  return cage;
}

Cage cage_around(ConstPoints x, std::span<const Triangle> triangles, std::span<const Quad> quads, const CageGrid& grid,
                 CageCells kept) {
  return cage_of(cells_around(x, triangles, quads, grid), grid, kept);
}

}  // namespace hexaplast
