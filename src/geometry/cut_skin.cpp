// SPDX-License-Identifier: LGPL-2.1-or-later
// An embedded surface is cut along with the hexahedra that carry it.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/skin_walls.hpp"
#include "hexaplast/geometry/cut_surface.hpp"
#include "mesh/selection.hpp"

namespace hexaplast {
namespace {

constexpr double kLongestEdge = 0.5;  // of triangles near the cut, in links between hexahedra
constexpr int kMaxRounds = 12;        // in which they are divided
constexpr double kNearest = 0.02;     // part of an edge that is left on either side of the cut

using Node = CutWalls::Node;

class SkinCut {
 public:
  SkinCut(const CutWalls& walls, ConstPoints points, std::span<const Quad> faces, const Embedding& embedding,
          int first_hexahedron, int num_hexahedra);

  CarriedSurface surface();

 private:
  /// Where the cut crosses an edge of the skin, from its lower end.
  struct Crossing {
    int node = -1;             // initial one, by which the ends are parted; -1: they are not
    std::array<int, 2> point;  // on the side of the lower end, and of the other
  };

  const Hexahedron& corners(int e) const { return walls_.mesh().hexahedra()[e]; }
  const Node* split_node(int e, int corner) const;
  bool is_near(int point) const { return is_near_[skin_.hexahedron[point]] != 0; }
  std::vector<int> common_corners(int p, int q) const;
  void refine();
  bool divide_long_edges();
  void take_sides();
  Crossing crossing_at(int p, int q);
  void divide();
  void divide_at(const Triangle& triangle, const std::array<Crossing, 3>& crossings);

  const CutWalls& walls_;
  const int first_, num_;
  DividedSkin skin_;
  std::vector<unsigned char> is_near_;  // per hexahedron: it has a node that is split
  Eigen::AlignedBox3d cut_;             // around these nodes, wider by a link
  std::map<Edge, Crossing> crossings_;
};

SkinCut::SkinCut(const CutWalls& walls, ConstPoints points, std::span<const Quad> faces, const Embedding& embedding,
                 int first_hexahedron, int num_hexahedra)
    : walls_(walls), first_(first_hexahedron), num_(num_hexahedra) {
  for (Eigen::Index n = 0; n < points.rows(); ++n) skin_.points.emplace_back(points.row(n).transpose());
  for (int n = 0; n < embedding.num_points(); ++n) skin_.hexahedron.push_back(first_ + embedding.hexahedron_of(n));
  for (const auto& [a, b, c, d] : faces) {
    skin_.triangles.push_back({a, b, c});
    if (c != d) skin_.triangles.push_back({a, c, d});
  }
  is_near_.assign(walls.mesh().num_elements(), 0);
  for (int e = first_; e < first_ + num_; ++e)
    for (int a = 0; a < kCorners; ++a)
      if (const Node* node = split_node(e, a)) {
        is_near_[e] = 1;
        cut_.extend(node->place);
      }
  if (cut_.isEmpty()) return;
  cut_.min().array() -= walls.mean_link();
  cut_.max().array() += walls.mean_link();
}

const Node* SkinCut::split_node(int e, int corner) const {
  const Node* node = walls_.node(walls_.initial_node(e, corner));
  return node && node->is_split() ? node : nullptr;
}

/// Corners of p's hexahedron at initial nodes that q's has too.
std::vector<int> SkinCut::common_corners(int p, int q) const {
  std::vector<int> common;
  const int e = skin_.hexahedron[p], other = skin_.hexahedron[q];
  for (int a = 0; a < kCorners; ++a)
    if (e == other || walls_.copy_at(other, walls_.initial_node(e, a)) >= 0) common.push_back(a);
  return common;
}

void SkinCut::refine() {
  for (int round = 0; round < kMaxRounds; ++round)
    if (!divide_long_edges()) return;
}

bool SkinCut::divide_long_edges() {
  std::map<Edge, int> middle;
  std::vector<Vec3> places;
  for (const Triangle& triangle : skin_.triangles) {
    Eigen::AlignedBox3d box;
    for (const int point : triangle) box.extend(skin_.points[point]);
    const bool comes_near = box.intersects(cut_);
    for (int k = 0; k < 3; ++k) {
      const Edge edge = sorted(Edge{triangle[k], triangle[(k + 1) % 3]});
      const auto [p, q] = edge;
      const double length = (skin_.points[q] - skin_.points[p]).norm();
      const bool may_be_crossed = is_near(p) || is_near(q) || (comes_near && length > walls_.mean_link());
      if (!may_be_crossed || middle.contains(edge)) continue;
      if (length <= kLongestEdge * walls_.mean_link() && !common_corners(p, q).empty()) continue;
      middle[edge] = static_cast<int>(skin_.points.size() + places.size());
      places.emplace_back((skin_.points[p] + skin_.points[q]) / 2);
    }
  }
  if (middle.empty()) return false;
  PointArray added(std::ssize(places), 3);
  for (std::size_t k = 0; k < places.size(); ++k) added.row(static_cast<Eigen::Index>(k)) = places[k].transpose();
  const Embedding embedding(walls_.mesh().positions(), std::span(walls_.mesh().hexahedra()).subspan(first_, num_),
                            added);
  for (std::size_t k = 0; k < places.size(); ++k)
    skin_.add_point(places[k], first_ + embedding.hexahedron_of(static_cast<int>(k)));

  std::vector<Triangle> fine;
  for (const Triangle& triangle : skin_.triangles) {
    std::array<int, 3> at{};  // middles of its edges; -1: none
    for (int k = 0; k < 3; ++k) {
      const auto found = middle.find(sorted(Edge{triangle[k], triangle[(k + 1) % 3]}));
      at[k] = found == middle.end() ? -1 : found->second;
    }
    const auto count = 3 - std::ranges::count(at, -1);
    if (count == 0) {
      fine.push_back(triangle);
      continue;
    }
    if (count == 3) {
      for (int k = 0; k < 3; ++k) fine.push_back({triangle[k], at[k], at[(k + 2) % 3]});
      fine.push_back(at);
      continue;
    }
    // turned so that its first edge has a middle, and its last one has none
    int k = 0;
    while (at[k] < 0 || at[(k + 2) % 3] >= 0) ++k;
    const int a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
    const int ab = at[k], bc = at[(k + 1) % 3];
    fine.push_back({a, ab, c});
    if (bc < 0) {
      fine.push_back({ab, b, c});
    } else {
      fine.push_back({ab, b, bc});
      fine.push_back({ab, bc, c});
    }
  }
  skin_.triangles = std::move(fine);
  return true;
}

/// Points go to the hexahedra of the side of the smooth wall that they lie on.
void SkinCut::take_sides() {
  const std::vector<int> before = skin_.hexahedron;
  for (std::size_t p = 0; p < skin_.points.size(); ++p) {
    const int e = skin_.hexahedron[p];
    const Node* nearest = nullptr;
    int own = -1;
    double distance = 0;
    for (int a = 0; a < kCorners && is_near_[e]; ++a) {
      const Node* node = split_node(e, a);
      if (!node || node->copies.size() != 2 || node->normal.isZero(0)) continue;
      const double away = (skin_.points[p] - node->place).norm();
      if (nearest && away >= distance) continue;
      nearest = node;
      own = walls_.copy(e, a);
      distance = away;
    }
    if (!nearest) continue;
    const int copy = nearest->copies[nearest->normal.dot(skin_.points[p] - nearest->middle) > 0 ? 1 : 0];
    if (copy == own) continue;
    if (const int carrier = walls_.carrier(*nearest, copy, skin_.points[p]); carrier >= 0)
      skin_.hexahedron[p] = carrier;
  }
  // neighbours whose hexahedra do not touch any more stay where they were
  for (bool has_changed = true; std::exchange(has_changed, false);)
    for (const Triangle& triangle : skin_.triangles)
      for (int k = 0; k < 3; ++k) {
        const int p = triangle[k], q = triangle[(k + 1) % 3];
        if ((skin_.hexahedron[p] == before[p] && skin_.hexahedron[q] == before[q]) || !common_corners(p, q).empty())
          continue;
        skin_.hexahedron[p] = before[p];
        skin_.hexahedron[q] = before[q];
        has_changed = true;
      }
}

/// Ends of an edge are parted if they have different copies of the nearest node that their hexahedra have in common.
SkinCut::Crossing SkinCut::crossing_at(int p, int q) {
  const auto [low, high] = std::minmax(p, q);
  const Edge edge{low, high};
  if (const auto found = crossings_.find(edge); found != crossings_.end()) return found->second;
  Crossing crossing{.node = -1, .point = {}};
  if (skin_.hexahedron[low] != skin_.hexahedron[high] && (is_near(low) || is_near(high))) {
    const int e = skin_.hexahedron[low], other = skin_.hexahedron[high];
    const Vec3 middle = (skin_.points[low] + skin_.points[high]) / 2;
    int nearest = -1;
    double distance = 0;
    bool shares_copy = false;
    for (const int a : common_corners(low, high)) {
      shares_copy = shares_copy || walls_.copy(e, a) == walls_.copy_at(other, walls_.initial_node(e, a));
      const double away = (walls_.mesh().positions().row(corners(e)[a]).transpose() - middle).norm();
      if (nearest >= 0 && away >= distance) continue;
      nearest = walls_.initial_node(e, a);
      distance = away;
    }
    if (nearest >= 0 && walls_.node(nearest) && walls_.copy_at(e, nearest) != walls_.copy_at(other, nearest) &&
        (!shares_copy || walls_.node(nearest)->copies.size() == 2)) {
      const Node& node = *walls_.node(nearest);
      const double from = node.normal.dot(skin_.points[low] - node.middle),
                   to = node.normal.dot(skin_.points[high] - node.middle);
      const double at = from * to < 0 ? std::clamp(from / (from - to), kNearest, 1 - kNearest) : 0.5;
      const Vec3 place = skin_.points[low] + at * (skin_.points[high] - skin_.points[low]);
      const int point = skin_.add_point(place, e);
      crossing = {nearest, {point, skin_.add_point(place, other)}};
    }
  }
  return crossings_[edge] = crossing;
}

void SkinCut::divide() {
  for (const Triangle& triangle : skin_.triangles) {
    std::array<Crossing, 3> crossings;
    for (int k = 0; k < 3; ++k) crossings[k] = crossing_at(triangle[k], triangle[(k + 1) % 3]);
    divide_at(triangle, crossings);
  }
}

void SkinCut::divide_at(const Triangle& triangle, const std::array<Crossing, 3>& crossings) {
  const auto add = [&](int a, int b, int c) { skin_.faces.push_back({a, b, c, c}); };
  const auto is_crossed = [&](int edge) { return crossings[edge % 3].node >= 0; };
  const auto corner = [&](int k) { return triangle[k % 3]; };
  /// The point on an edge on the side of a corner, and the copy that it is joined to.
  const auto on = [&](int edge, int k) {
    const Crossing& crossing = crossings[edge % 3];
    const bool is_low = corner(k) == std::min(corner(edge), corner(edge + 1));
    return std::pair(crossing.point[is_low ? 0 : 1], walls_.copy_at(skin_.hexahedron[corner(k)], crossing.node));
  };
  const auto count = std::ranges::count_if(crossings, [](const Crossing& one) { return one.node >= 0; });
  int k = 0;
  if (count == 0) {
    add(triangle[0], triangle[1], triangle[2]);
  } else if (count == 1) {  // the cut ends at the corner across
    while (!is_crossed(k)) ++k;
    const auto [one, copy_of_one] = on(k, k);
    const auto [other, copy_of_other] = on(k, k + 1);
    add(corner(k), one, corner(k + 2));
    add(other, corner(k + 1), corner(k + 2));
    skin_.lips.push_back({one, corner(k + 2), copy_of_one, -1});
    skin_.lips.push_back({corner(k + 2), other, -1, copy_of_other});
  } else if (count == 2) {  // corner k alone on its side
    while (!is_crossed(k) || !is_crossed(k + 2)) ++k;
    const auto [next, copy_of_next] = on(k, k);
    const auto [last, copy_of_last] = on(k + 2, k);
    add(corner(k), next, last);
    skin_.lips.push_back({next, last, copy_of_next, copy_of_last});
    const auto [across_next, copy_across_next] = on(k, k + 1);
    const auto [across_last, copy_across_last] = on(k + 2, k + 2);
    add(across_next, corner(k + 1), corner(k + 2));
    add(across_next, corner(k + 2), across_last);
    skin_.lips.push_back({across_last, across_next, copy_across_last, copy_across_next});
  } else {
    Vec3 place = Vec3::Zero();
    for (const Crossing& crossing : crossings) place += skin_.points[crossing.point[0]] / 3;
    // on all sides the middle is joined to one node, where they have one
    std::array<int, 3> middle, copy_of_middle;
    for (k = 0; k < 3; ++k) {
      middle[k] = skin_.add_point(place, skin_.hexahedron[corner(k)]);
      copy_of_middle[k] = on(k, k).second;
    }
    std::size_t most = 0;
    for (const Crossing& crossing : crossings) {
      std::array<int, 3> copies;
      for (k = 0; k < 3; ++k) copies[k] = walls_.copy_at(skin_.hexahedron[corner(k)], crossing.node);
      const std::size_t num_copies = walls_.node(crossing.node)->copies.size();
      if (std::ranges::count(copies, -1) > 0 || num_copies <= most) continue;
      most = num_copies;
      copy_of_middle = copies;
    }
    for (k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const auto [near, copy_near] = on(k, k);
      const auto [far, copy_far] = on(k, k + 1);
      add(corner(k), near, middle[k]);
      add(corner(k + 1), middle[next], far);
      skin_.lips.push_back({near, middle[k], copy_near, copy_of_middle[k]});
      skin_.lips.push_back({middle[next], far, copy_of_middle[next], copy_far});
    }
  }
}

CarriedSurface SkinCut::surface() {
  refine();
  take_sides();
  divide();
  const std::size_t num_faces = skin_.faces.size();
  add_walls(walls_, first_, num_, skin_);
  CarriedSurface surface{PointArray(std::ssize(skin_.points), 3), skin_.hexahedron, skin_.faces,
                         std::vector<unsigned char>(num_faces, 0)};
  surface.is_wall.resize(skin_.faces.size(), 1);
  for (std::size_t n = 0; n < skin_.points.size(); ++n)
    surface.points.row(static_cast<Eigen::Index>(n)) = skin_.points[n].transpose();
  return surface;
}

}  // namespace

CarriedSurface cut_skin(const CutWalls& walls, ConstPoints points, std::span<const Quad> faces,
                        const Embedding& embedding, int first_hexahedron, int num_hexahedra) {
  return SkinCut(walls, points, faces, embedding, first_hexahedron, num_hexahedra).surface();
}

}  // namespace hexaplast
