// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/plane_cut.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/require.hpp"

namespace hexaplast {
namespace {

// The places between which the tetrahedra of a cell stand: its corners, the means of its faces, its own mean.
constexpr int kNumFaces = static_cast<int>(kFaces.size());
constexpr int kMiddle = kCorners + kNumFaces;
constexpr int kNumPlaces = kMiddle + 1;

using Weights = std::array<double, kCorners>;  // of the corners of a hexahedron

/// One of the cells into which a hexahedron is divided.
struct Cell {
  std::array<Weights, kNumPlaces> weights{};
  std::array<bool, kNumFaces> is_outside{};  // which of its faces lie on those of the hexahedron
};

std::vector<Cell> cells_of_hexahedron(int parts) {
  std::vector<Cell> cells;
  for (int k = 0; k < parts; ++k)
    for (int j = 0; j < parts; ++j)
      for (int i = 0; i < parts; ++i) {
        Cell cell;
        const std::array<int, 3> at{i, j, k};
        for (int c = 0; c < kCorners; ++c)
          for (int a = 0; a < kCorners; ++a) {
            double& weight = cell.weights[c][a] = 1;
            for (int d = 0; d < 3; ++d) {
              const double fraction = static_cast<double>(at[d] + (kCornerSign[c][d] > 0)) / parts;
              weight *= kCornerSign[a][d] > 0 ? fraction : 1 - fraction;
            }
            cell.weights[kMiddle][a] += weight / kCorners;
          }
        for (int f = 0; f < kNumFaces; ++f) {
          for (const int c : kFaces[f])
            for (int a = 0; a < kCorners; ++a) cell.weights[kCorners + f][a] += cell.weights[c][a] / 4;
          // a face of the hexahedron gives no weight to the corners that it has not
          double others = 0;
          for (int a = 0; a < kCorners; ++a)
            if (std::ranges::find(kFaces[f], a) == kFaces[f].end()) others += cell.weights[kCorners + f][a];
          cell.is_outside[f] = others == 0;
        }
        cells.push_back(cell);
      }
  return cells;
}

/// Where the way from one height to another, of which one is negative, meets 0: the fraction of the second.
double fraction_at_plane(double from, double to) { return from / (from - to); }

/// A height, or 0 where it is one of rounding: neighbours must agree on which side a place lies that they share, though
/// each of them comes to its height by another way.
double without_rounding(double height, const std::array<double, kCorners>& corner_height) {
  constexpr double kRounding = 1e-12;
  double size = 0;
  for (const double corner : corner_height) size = std::max(size, std::abs(corner));
  return std::abs(height) <= kRounding * size ? 0 : height;
}

/// The points of one cell's cut: one on every line between two of its places that passes through the plane.
class Crossings {
 public:
  Crossings(const Cell& cell, const std::array<double, kNumPlaces>& height) : cell_(cell), height_(height) {
    for (auto& row : point_) row.fill(-1);
  }

  /// Number of the point between two places; `add` makes one of its weights and returns its number.
  template <class Add>
  int between(int p, int q, const Add& add) {
    if (p > q) std::swap(p, q);
    int& point = point_[p][q];
    if (point >= 0) return point;
    const double fraction = fraction_at_plane(height_[p], height_[q]);
    Weights weights;
    for (int a = 0; a < kCorners; ++a)
      weights[a] = (1 - fraction) * cell_.weights[p][a] + fraction * cell_.weights[q][a];
    return point = add(weights);
  }

 private:
  const Cell& cell_;
  const std::array<double, kNumPlaces>& height_;
  std::array<std::array<int, kNumPlaces>, kNumPlaces> point_;
};

}  // namespace

PlaneCut::PlaneCut(ConstPoints x, std::span<const Hexahedron> hexahedra, const Plane& plane,
                   std::span<const unsigned char> alive, int parts, double tolerance)
    : num_nodes_(x.rows()) {
  for (const Hexahedron& corners : hexahedra) require_nodes("PlaneCut", corners, num_nodes_);
  if (!alive.empty()) require_count("PlaneCut", "alive", std::ssize(alive), std::ssize(hexahedra));
  const std::vector<Cell> cells = cells_of_hexahedron(parts);
  struct CutFace {
    std::vector<Edge> lines;
    int num_hexahedra = 0;
  };
  std::map<Quad, CutFace> cut_faces;
  std::vector<Quad> order;  // of cut_faces: the result must not depend on how nodes are numbered

  std::vector<Vec3> place;  // [m] of every point
  const auto add_triangle = [&](int a, int b, int c) {
    const Vec3 normal = (place[b] - place[a]).cross(place[c] - place[a]);
    area_ += normal.norm() / 2;
    if (normal.dot(plane.normal) < 0) std::swap(b, c);
    triangles_.push_back({a, b, c});
  };

  const auto add_cell = [&](const Cell& cell, const Hexahedron& corners,
                            const std::array<double, kCorners>& corner_height,
                            std::array<std::vector<Edge>, kNumFaces>& lines) {
    std::array<double, kNumPlaces> height{};
    for (int p = 0; p < kNumPlaces; ++p) {
      for (int a = 0; a < kCorners; ++a) height[p] += cell.weights[p][a] * corner_height[a];
      height[p] = without_rounding(height[p], corner_height);
    }
    const auto is_above = [&](int p) { return height[p] >= 0; };
    const auto num_places_above = std::ranges::count_if(height, [](double h) { return h >= 0; });
    if (num_places_above == 0 || num_places_above == kNumPlaces) return;

    Crossings crossings(cell, height);
    const auto add_point = [&](const Weights& weights) {
      Vec3 at = Vec3::Zero();
      for (int a = 0; a < kCorners; ++a) at += weights[a] * x.row(corners[a]).transpose();
      place.push_back(at);
      anchors_.push_back({corners, weights});
      return static_cast<int>(anchors_.size()) - 1;
    };
    const auto between = [&](int p, int q) { return crossings.between(p, q, add_point); };

    for (int f = 0; f < kNumFaces; ++f)
      for (int k = 0; k < 4; ++k) {
        // above stand the first `num_above` of the four, below the others
        std::array<int, 4> tetrahedron{kFaces[f][k], kFaces[f][(k + 1) % 4], kCorners + f, kMiddle};
        const auto num_above = std::partition(tetrahedron.begin(), tetrahedron.end(), is_above) - tetrahedron.begin();
        const auto& [p, q, r, s] = tetrahedron;
        if (num_above == 1) {
          add_triangle(between(p, q), between(p, r), between(p, s));
        } else if (num_above == 3) {
          add_triangle(between(p, s), between(q, s), between(r, s));
        } else if (num_above == 2) {
          const int pr = between(p, r), ps = between(p, s), qr = between(q, r), qs = between(q, s);
          add_triangle(pr, ps, qs);
          add_triangle(pr, qs, qr);
        }
        if (!cell.is_outside[f]) continue;

        // where the plane meets the face itself
        std::array<int, 3> triangle{kFaces[f][k], kFaces[f][(k + 1) % 4], kCorners + f};
        const auto low = std::partition(triangle.begin(), triangle.end(), is_above) - triangle.begin();
        const auto& [u, v, w] = triangle;
        if (low == 1) lines[f].push_back({between(u, v), between(u, w)});
        if (low == 2) lines[f].push_back({between(u, w), between(v, w)});
      }
  };

  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    if (!alive.empty() && !alive[e]) continue;
    const Hexahedron& corners = hexahedra[e];
    std::array<double, kCorners> corner_height{};
    for (int a = 0; a < kCorners; ++a) corner_height[a] = plane.height(x.row(corners[a]).transpose());
    for (double& height : corner_height)
      height = std::abs(height) < tolerance ? 0 : without_rounding(height, corner_height);
    const auto [min, max] = std::ranges::minmax(corner_height);
    if (min >= 0 || max < 0) continue;

    std::array<std::vector<Edge>, kNumFaces> lines;
    for (const Cell& cell : cells) add_cell(cell, corners, corner_height, lines);
    for (int f = 0; f < kNumFaces; ++f) {
      if (lines[f].empty()) continue;
      const Quad face = sorted(face_of(corners, kFaces[f]));
      const auto [found, is_new] = cut_faces.try_emplace(face);
      if (is_new) {
        order.push_back(face);
        found->second.lines = std::move(lines[f]);
      }
      ++found->second.num_hexahedra;
    }
  }

  for (const Quad& face : order) {
    const CutFace& cut = cut_faces[face];
    std::vector<Edge>& lines = cut.num_hexahedra == 1 ? outline_ : inner_lines_;
    lines.insert(lines.end(), cut.lines.begin(), cut.lines.end());
  }
}

void PlaneCut::apply(ConstPoints nodes, Points points) const {
  require_rows("PlaneCut::apply", "nodes", nodes, num_nodes_);
  require_rows("PlaneCut::apply", "points", points, num_points());
  for (std::size_t n = 0; n < anchors_.size(); ++n) {
    Vec3 value = Vec3::Zero();
    for (int a = 0; a < kCorners; ++a)
      if (anchors_[n].weight[a] != 0) value += anchors_[n].weight[a] * nodes.row(anchors_[n].corners[a]).transpose();
    points.row(static_cast<Eigen::Index>(n)) = value.transpose();
  }
}

std::pair<double, double> extent_along(const Vec3& normal, ConstPoints x, std::span<const Hexahedron> hexahedra,
                                       std::span<const unsigned char> alive) {
  if (!alive.empty()) require_count("extent_along", "alive", std::ssize(alive), std::ssize(hexahedra));
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    if (!alive.empty() && !alive[e]) continue;
    require_nodes("extent_along", hexahedra[e], x.rows());
    for (const int node : hexahedra[e]) {
      const double along = normal.dot(x.row(node).transpose());
      min = std::min(min, along);
      max = std::max(max, along);
    }
  }
  return min <= max ? std::pair(min, max) : std::pair(0.0, 0.0);
}

}  // namespace hexaplast
