// SPDX-License-Identifier: LGPL-2.1-or-later
// An embedded surface is cut along with the hexahedra that carry it.
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <numbers>
#include <set>
#include <span>
#include <utility>

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
  /// An edge of a lip, as the skin runs along it, and the copies of wall nodes that its ends are joined to. Each second
  /// one lies across the one before, and runs the other way.
  struct Lip {
    int from, to;
    int copy_from, copy_to;  // -1: the cut ends here
  };

  const Hexahedron& corners(int e) const { return walls_.mesh().hexahedra()[e]; }
  const Node* split_node(int e, int corner) const;
  bool is_near(int point) const { return is_near_[hexahedron_[point]] != 0; }
  std::vector<int> common_corners(int p, int q) const;
  int add_point(const Vec3& place, int hexahedron);
  void refine();
  bool divide_long_edges();
  void take_sides();
  Crossing crossing_at(int p, int q);
  void divide();
  void divide_at(const Triangle& triangle, const std::array<Crossing, 3>& crossings);

  // walls, on copies of nodes
  struct WallFace {
    CutWalls::Wall wall;
    Quad copies;
  };
  void find_walls();
  std::vector<Edge> way(const Edge& from, const std::function<bool(const Edge&)>& is_goal) const;
  void end_lips();
  void add_strips();
  void add_strip(const Lip& lip, const std::vector<int>& nodes, bool is_across);
  bool winds_around(const Vec3& place) const;
  std::vector<unsigned char> inside() const;
  void add_walls();
  void fill_holes();

  const CutWalls& walls_;
  const int first_, num_;
  std::vector<Vec3> points_;
  std::vector<int> hexahedron_;
  std::vector<Triangle> triangles_;
  std::vector<unsigned char> is_near_;  // per hexahedron: it has a node that is split
  Eigen::AlignedBox3d cut_;             // around these nodes, wider by a link
  std::map<Edge, Crossing> crossings_;
  std::vector<Quad> faces_;
  std::vector<unsigned char> is_wall_;
  std::vector<Lip> lips_;
  std::vector<WallFace> wall_faces_;
  std::map<int, int> initial_;                // of copies on walls
  std::set<int> is_front_;                    // copies that the walls on both sides of a face have
  std::map<int, std::vector<int>> beside_;    // along edges of walls, by initial nodes
  std::map<int, std::pair<Vec3, int>> pull_;  // by initial node: sum of places on lips, and how many
  std::map<Edge, int> joined_;                // edges of walls along strips: how often
  std::vector<std::pair<Triangle, std::array<bool, 3>>> strips_;  // which corners are copies
};

SkinCut::SkinCut(const CutWalls& walls, ConstPoints points, std::span<const Quad> faces, const Embedding& embedding,
                 int first_hexahedron, int num_hexahedra)
    : walls_(walls), first_(first_hexahedron), num_(num_hexahedra) {
  for (Eigen::Index n = 0; n < points.rows(); ++n) points_.emplace_back(points.row(n).transpose());
  for (int n = 0; n < embedding.num_points(); ++n) hexahedron_.push_back(first_ + embedding.hexahedron_of(n));
  for (const auto& [a, b, c, d] : faces) {
    triangles_.push_back({a, b, c});
    if (c != d) triangles_.push_back({a, c, d});
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
  const int e = hexahedron_[p], other = hexahedron_[q];
  for (int a = 0; a < kCorners; ++a)
    if (e == other || walls_.copy_at(other, walls_.initial_node(e, a)) >= 0) common.push_back(a);
  return common;
}

int SkinCut::add_point(const Vec3& place, int hexahedron) {
  points_.push_back(place);
  hexahedron_.push_back(hexahedron);
  return static_cast<int>(points_.size()) - 1;
}

void SkinCut::refine() {
  for (int round = 0; round < kMaxRounds; ++round)
    if (!divide_long_edges()) return;
}

bool SkinCut::divide_long_edges() {
  std::map<Edge, int> middle;
  std::vector<Vec3> places;
  for (const Triangle& triangle : triangles_) {
    Eigen::AlignedBox3d box;
    for (const int point : triangle) box.extend(points_[point]);
    const bool comes_near = box.intersects(cut_);
    for (int k = 0; k < 3; ++k) {
      const Edge edge = sorted(Edge{triangle[k], triangle[(k + 1) % 3]});
      const auto [p, q] = edge;
      const double length = (points_[q] - points_[p]).norm();
      const bool may_be_crossed = is_near(p) || is_near(q) || (comes_near && length > walls_.mean_link());
      if (!may_be_crossed || middle.contains(edge)) continue;
      if (length <= kLongestEdge * walls_.mean_link() && !common_corners(p, q).empty()) continue;
      middle[edge] = static_cast<int>(points_.size() + places.size());
      places.emplace_back((points_[p] + points_[q]) / 2);
    }
  }
  if (middle.empty()) return false;
  PointArray added(std::ssize(places), 3);
  for (std::size_t k = 0; k < places.size(); ++k) added.row(static_cast<Eigen::Index>(k)) = places[k].transpose();
  const Embedding embedding(walls_.mesh().positions(), std::span(walls_.mesh().hexahedra()).subspan(first_, num_),
                            added);
  for (std::size_t k = 0; k < places.size(); ++k)
    add_point(places[k], first_ + embedding.hexahedron_of(static_cast<int>(k)));

  std::vector<Triangle> fine;
  for (const Triangle& triangle : triangles_) {
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
  triangles_ = std::move(fine);
  return true;
}

/// Points go to the hexahedra of the side of the smooth wall that they lie on.
void SkinCut::take_sides() {
  const std::vector<int> before = hexahedron_;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const int e = hexahedron_[p];
    const Node* nearest = nullptr;
    int own = -1;
    double distance = 0;
    for (int a = 0; a < kCorners && is_near_[e]; ++a) {
      const Node* node = split_node(e, a);
      if (!node || node->copies.size() != 2 || node->normal.isZero(0)) continue;
      const double away = (points_[p] - node->place).norm();
      if (nearest && away >= distance) continue;
      nearest = node;
      own = walls_.copy(e, a);
      distance = away;
    }
    if (!nearest) continue;
    const int copy = nearest->copies[nearest->normal.dot(points_[p] - nearest->middle) > 0 ? 1 : 0];
    if (copy == own) continue;
    if (const int carrier = walls_.carrier(*nearest, copy, points_[p]); carrier >= 0) hexahedron_[p] = carrier;
  }
  // neighbours whose hexahedra do not touch any more stay where they were
  for (bool has_changed = true; std::exchange(has_changed, false);)
    for (const Triangle& triangle : triangles_)
      for (int k = 0; k < 3; ++k) {
        const int p = triangle[k], q = triangle[(k + 1) % 3];
        if ((hexahedron_[p] == before[p] && hexahedron_[q] == before[q]) || !common_corners(p, q).empty()) continue;
        hexahedron_[p] = before[p];
        hexahedron_[q] = before[q];
        has_changed = true;
      }
}

/// Ends of an edge are parted if they have different copies of the nearest node that their hexahedra have in common.
SkinCut::Crossing SkinCut::crossing_at(int p, int q) {
  const auto [low, high] = std::minmax(p, q);
  const Edge edge{low, high};
  if (const auto found = crossings_.find(edge); found != crossings_.end()) return found->second;
  Crossing crossing{.node = -1, .point = {}};
  if (hexahedron_[low] != hexahedron_[high] && (is_near(low) || is_near(high))) {
    const int e = hexahedron_[low], other = hexahedron_[high];
    const Vec3 middle = (points_[low] + points_[high]) / 2;
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
      const double from = node.normal.dot(points_[low] - node.middle),
                   to = node.normal.dot(points_[high] - node.middle);
      const double at = from * to < 0 ? std::clamp(from / (from - to), kNearest, 1 - kNearest) : 0.5;
      const Vec3 place = points_[low] + at * (points_[high] - points_[low]);
      const int point = add_point(place, e);
      crossing = {nearest, {point, add_point(place, other)}};
    }
  }
  return crossings_[edge] = crossing;
}

void SkinCut::divide() {
  for (const Triangle& triangle : triangles_) {
    std::array<Crossing, 3> crossings;
    for (int k = 0; k < 3; ++k) crossings[k] = crossing_at(triangle[k], triangle[(k + 1) % 3]);
    divide_at(triangle, crossings);
  }
  is_wall_.assign(faces_.size(), 0);
}

void SkinCut::divide_at(const Triangle& triangle, const std::array<Crossing, 3>& crossings) {
  const auto add = [&](int a, int b, int c) { faces_.push_back({a, b, c, c}); };
  const auto is_crossed = [&](int edge) { return crossings[edge % 3].node >= 0; };
  const auto corner = [&](int k) { return triangle[k % 3]; };
  /// The point on an edge on the side of a corner, and the copy that it is joined to.
  const auto on = [&](int edge, int k) {
    const Crossing& crossing = crossings[edge % 3];
    const bool is_low = corner(k) == std::min(corner(edge), corner(edge + 1));
    return std::pair(crossing.point[is_low ? 0 : 1], walls_.copy_at(hexahedron_[corner(k)], crossing.node));
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
    lips_.push_back({one, corner(k + 2), copy_of_one, -1});
    lips_.push_back({corner(k + 2), other, -1, copy_of_other});
  } else if (count == 2) {  // corner k alone on its side
    while (!is_crossed(k) || !is_crossed(k + 2)) ++k;
    const auto [next, copy_of_next] = on(k, k);
    const auto [last, copy_of_last] = on(k + 2, k);
    add(corner(k), next, last);
    lips_.push_back({next, last, copy_of_next, copy_of_last});
    const auto [across_next, copy_across_next] = on(k, k + 1);
    const auto [across_last, copy_across_last] = on(k + 2, k + 2);
    add(across_next, corner(k + 1), corner(k + 2));
    add(across_next, corner(k + 2), across_last);
    lips_.push_back({across_last, across_next, copy_across_last, copy_across_next});
  } else {
    Vec3 place = Vec3::Zero();
    for (const Crossing& crossing : crossings) place += points_[crossing.point[0]] / 3;
    // on all sides the middle is joined to one node, where they have one
    std::array<int, 3> middle, copy_of_middle;
    for (k = 0; k < 3; ++k) {
      middle[k] = add_point(place, hexahedron_[corner(k)]);
      copy_of_middle[k] = on(k, k).second;
    }
    std::size_t most = 0;
    for (const Crossing& crossing : crossings) {
      std::array<int, 3> copies;
      for (k = 0; k < 3; ++k) copies[k] = walls_.copy_at(hexahedron_[corner(k)], crossing.node);
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
      lips_.push_back({near, middle[k], copy_near, copy_of_middle[k]});
      lips_.push_back({middle[next], far, copy_of_middle[next], copy_far});
    }
  }
}

void SkinCut::find_walls() {
  std::map<int, std::vector<std::pair<int, int>>> beside;  // initial node and copy
  for (const CutWalls::Wall& wall : walls_.walls()) {
    if (wall.hexahedron < first_ || wall.hexahedron >= first_ + num_) continue;
    WallFace& face = wall_faces_.emplace_back(WallFace{wall, {}});
    for (int k = 0; k < 4; ++k) {
      const int corner = kFaces[wall.side][k];
      face.copies[k] = walls_.copy(wall.hexahedron, corner);
      initial_[face.copies[k]] = walls_.initial_node(wall.hexahedron, corner);
    }
    for (int k = 0; k < 4; ++k) {
      const int one = face.copies[k], next = face.copies[(k + 1) % 4];
      beside[one].emplace_back(initial_[next], next);
      beside[next].emplace_back(initial_[one], one);
    }
  }
  std::map<Quad, std::vector<int>> copies_at;  // by the initial nodes of a face
  for (const WallFace& face : wall_faces_) {
    Quad initial;
    std::ranges::transform(face.copies, initial.begin(), [&](int copy) { return initial_.at(copy); });
    std::vector<int>& known = copies_at[sorted(initial)];
    for (const int copy : face.copies)
      if (std::ranges::count(known, copy) > 0) is_front_.insert(copy);
    known.insert(known.end(), face.copies.begin(), face.copies.end());
  }
  for (auto& [copy, others] : beside) {
    std::ranges::sort(others);
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const auto& [initial, other] : others) beside_[copy].push_back(other);
  }
}

/// A shortest way along edges that the walls on both sides have, to the first pair of copies that is a goal. Empty:
/// none.
std::vector<Edge> SkinCut::way(const Edge& from, const std::function<bool(const Edge&)>& is_goal) const {
  std::map<Edge, Edge> before{{from, from}};
  std::deque<Edge> next{from};
  while (!next.empty()) {
    const Edge copies = next.front();
    next.pop_front();
    if (is_goal(copies)) {
      std::vector<Edge> found{copies};
      while (found.back() != from) found.push_back(before.at(found.back()));
      std::ranges::reverse(found);
      return found;
    }
    const auto one = beside_.find(copies[0]), other = beside_.find(copies[1]);
    if (one == beside_.end() || other == beside_.end()) continue;
    for (const int a : one->second)
      for (const int b : other->second)
        if (initial_.at(a) == initial_.at(b) && before.emplace(Edge{a, b}, copies).second) next.push_back({a, b});
  }
  return {};
}

/// A cut that ends within the skin is joined to where it ends within the hexahedra: there both walls have one node.
void SkinCut::end_lips() {
  std::map<int, int> end_of;  // point of the skin
  const auto end = [&](int point, int copy) {
    if (const auto found = end_of.find(point); found != end_of.end()) return found->second;
    const std::vector<Edge> found = way({copy, copy}, [&](const Edge& other) { return is_front_.contains(other[0]); });
    return end_of[point] = found.empty() ? -1 : found.back()[0];
  };
  for (Lip& lip : lips_) {
    if (lip.copy_from < 0) lip.copy_from = end(lip.from, lip.copy_to);
    if (lip.copy_to < 0) lip.copy_to = end(lip.to, lip.copy_from);
  }
}

/// Strips across each other run along the same initial nodes where both sides have such a way.
void SkinCut::add_strips() {
  for (std::size_t l = 0; l < lips_.size(); l += 2) {
    const Lip &lip = lips_[l], &across = lips_[l + 1];
    const auto between = [&](const Edge& from, const Edge& to) {
      return initial_.contains(from[0]) && initial_.contains(from[1])
                 ? way(from, [&](const Edge& copies) { return copies == to; })
                 : std::vector<Edge>();
    };
    std::vector<Edge> one = between({lip.copy_from, across.copy_to}, {lip.copy_to, across.copy_from}), other = one;
    if (one.empty()) {
      one = between({lip.copy_from, lip.copy_from}, {lip.copy_to, lip.copy_to});
      other = between({across.copy_to, across.copy_to}, {across.copy_from, across.copy_from});
    }
    std::vector<int> nodes, nodes_across;
    for (const Edge& copies : one) nodes.push_back(copies[0]);
    for (const Edge& copies : other) nodes_across.push_back(copies[1]);
    std::ranges::reverse(nodes_across);
    add_strip(lip, nodes, false);
    add_strip(across, nodes_across, true);
  }
}

void SkinCut::add_strip(const Lip& lip, const std::vector<int>& nodes, bool is_across) {
  if (nodes.empty()) return;
  strips_.push_back({{lip.to, lip.from, is_across ? nodes.back() : nodes[0]}, {false, false, true}});
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    strips_.push_back({{is_across ? lip.from : lip.to, nodes[k], nodes[k + 1]}, {false, true, true}});
    ++joined_[sorted(Edge{nodes[k], nodes[k + 1]})];
  }
  const auto pull = [&](int copy, double at) {
    auto& [sum, count] = pull_.try_emplace(initial_.at(copy), Vec3::Zero(), 0).first->second;
    sum += points_[lip.from] + at * (points_[lip.to] - points_[lip.from]);
    ++count;
  };
  const double last = std::max(1.0, static_cast<double>(nodes.size()) - 1);
  for (std::size_t k = 0; k < nodes.size(); ++k) pull(nodes[k], static_cast<double>(k) / last);
  if (nodes.size() == 1) pull(nodes[0], 1);
}

/// Whether a place lies within the skin.
bool SkinCut::winds_around(const Vec3& place) const {
  double angle = 0;
  for (const auto& [p, q, r] : triangles_)
    angle += solid_angle(points_[p] - place, points_[q] - place, points_[r] - place);
  return std::abs(angle) > 2 * std::numbers::pi;
}

/// Per face of a wall, whether it lies within the skin, with the walls on its other sides: strips and walls together
/// have an even number of faces at each edge. Beyond an edge that one wall alone has lies the outside of all hexahedra.
std::vector<unsigned char> SkinCut::inside() const {
  std::map<Edge, std::vector<int>> faces_at;
  std::map<Quad, std::vector<int>> sides;
  const auto initial_of = [&](int face) {
    Quad initial;
    std::ranges::transform(wall_faces_[face].copies, initial.begin(), [&](int copy) { return initial_.at(copy); });
    return sorted(initial);
  };
  for (std::size_t f = 0; f < wall_faces_.size(); ++f) {
    sides[initial_of(static_cast<int>(f))].push_back(static_cast<int>(f));
    for (int k = 0; k < 4; ++k)
      faces_at[sorted(Edge{wall_faces_[f].copies[k], wall_faces_[f].copies[(k + 1) % 4]})].push_back(
          static_cast<int>(f));
  }
  const auto is_joined = [&](const Edge& edge) {
    const auto found = joined_.find(edge);
    return found != joined_.end() && found->second % 2 != 0;
  };
  std::vector<signed char> state(wall_faces_.size(), -1);
  std::deque<Edge> next;  // where the state of a face may follow
  const auto set = [&](int first, bool is_inside) {
    for (const int face : sides[initial_of(first)]) {
      state[face] = is_inside ? 1 : 0;
      for (int k = 0; k < 4; ++k)
        next.push_back(sorted(Edge{wall_faces_[face].copies[k], wall_faces_[face].copies[(k + 1) % 4]}));
    }
  };
  const auto spread = [&] {
    for (; !next.empty(); next.pop_front()) {
      int unknown = -1, num_unknown = 0;
      bool is_odd = is_joined(next.front());
      for (const int face : faces_at[next.front()]) {
        if (state[face] < 0) unknown = face;
        num_unknown += state[face] < 0 ? 1 : 0;
        is_odd = is_odd != (state[face] > 0);
      }
      if (num_unknown == 1) set(unknown, is_odd);
    }
  };
  // Returns at how many edges the number of faces is odd.
  const auto decide = [&](bool from_outside) {
    std::ranges::fill(state, -1);
    if (from_outside)
      for (const auto& [edge, around] : faces_at) next.push_back(edge);
    spread();
    for (const bool may_be_at_lips : {false, true}) {
      for (std::size_t f = 0; f < state.size(); ++f) {
        const auto is_at_lip = [&](int copy) { return pull_.contains(initial_.at(copy)); };
        if (state[f] >= 0 || (!may_be_at_lips && std::ranges::any_of(wall_faces_[f].copies, is_at_lip))) continue;
        Vec3 middle = Vec3::Zero();
        for (const int copy : wall_faces_[f].copies) middle += walls_.node(initial_.at(copy))->place / 4;
        set(static_cast<int>(f), winds_around(middle));
        if (from_outside || may_be_at_lips) spread();
      }
      spread();
    }
    return std::ranges::count_if(faces_at, [&](const auto& at) {
      const auto count = std::ranges::count_if(at.second, [&](int face) { return state[face] > 0; });
      return (count % 2 != 0) != is_joined(at.first);
    });
  };
  if (const auto num_odd = decide(true); num_odd > 0) {  // a lip without a way along walls
    std::vector<signed char> from_outside = state;
    if (decide(false) >= num_odd) state = std::move(from_outside);
  }
  return {state.begin(), state.end()};
}

void SkinCut::add_walls() {
  std::map<int, int> point_of;  // copies
  const auto point = [&](int copy) {
    const auto [entry, is_new] = point_of.emplace(copy, -1);
    if (!is_new) return entry->second;
    const int initial = initial_.at(copy);
    const Node& node = *walls_.node(initial);
    const auto pulled = pull_.find(initial);
    const Vec3 place = pulled == pull_.end() ? node.place : Vec3(pulled->second.first / pulled->second.second);
    return entry->second = add_point(place, walls_.carrier(node, copy, place));
  };
  for (const auto& [corners, are_copies] : strips_) {
    Triangle triangle = corners;
    for (int k = 0; k < 3; ++k)
      if (are_copies[k]) triangle[k] = point(corners[k]);
    faces_.push_back({triangle[0], triangle[1], triangle[2], triangle[2]});
  }
  const std::vector<unsigned char> is_inside = inside();
  for (std::size_t f = 0; f < wall_faces_.size(); ++f) {
    if (!is_inside[f]) continue;
    Quad quad = wall_faces_[f].copies;
    for (int& corner : quad) corner = point(corner);
    faces_.push_back(quad);
  }
  fill_holes();
  is_wall_.resize(faces_.size(), 1);
}

/// Where lips end at nodes from which no wall leads on, as at a notch of the hexahedra, edges of lips, strips and walls
/// have an odd number of faces: these form rings, which fans fill. Where the skin was open before, it stays so.
void SkinCut::fill_holes() {
  std::map<Edge, std::pair<int, int>> faces_at;  // how many, and how many more run up along it
  const auto add_edge = [&](int from, int to) {
    if (from == to) return;
    auto& [count, up] = faces_at[sorted(Edge{from, to})];
    ++count;
    up += from < to ? 1 : -1;
  };
  for (const Lip& lip : lips_) add_edge(lip.from, lip.to);
  for (const Quad& face : std::span(faces_).subspan(is_wall_.size()))  // behind those of the skin
    for (int k = 0; k < 4; ++k) add_edge(face[k], face[(k + 1) % 4]);
  std::map<int, std::vector<int>> beside;
  for (const auto& [edge, faces] : faces_at)
    if (faces.first % 2 != 0)
      for (const int k : {0, 1}) beside[edge[k]].push_back(edge[1 - k]);
  const auto leave = [&](int from, int to) { beside[from].erase(std::ranges::find(beside[from], to)); };
  for (const auto& entry : beside) {
    std::vector<int> way{entry.first};
    while (!beside[way.back()].empty()) {
      const int from = way.back(), to = beside[from].back();
      leave(from, to);
      leave(to, from);
      const auto ring = std::ranges::find(way, to);
      if (ring == way.end()) {
        way.push_back(to);
        continue;
      }
      std::vector<int> corners(ring, way.end());
      way.erase(ring + 1, way.end());
      int same = 0;  // as the faces run
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const int one = corners[k], next = corners[(k + 1) % corners.size()];
        same += (one < next ? 1 : -1) * faces_at[sorted(Edge{one, next})].second;
      }
      if (same > 0) std::ranges::reverse(corners);
      for (std::size_t k = 1; k + 1 < corners.size(); ++k)
        faces_.push_back({corners[0], corners[k], corners[k + 1], corners[k + 1]});
    }
  }
}

CarriedSurface SkinCut::surface() {
  refine();
  take_sides();
  divide();
  find_walls();
  end_lips();
  add_strips();
  add_walls();
  CarriedSurface surface{PointArray(std::ssize(points_), 3), hexahedron_, faces_, is_wall_};
  for (std::size_t n = 0; n < points_.size(); ++n)
    surface.points.row(static_cast<Eigen::Index>(n)) = points_[n].transpose();
  return surface;
}

}  // namespace

CarriedSurface cut_skin(const CutWalls& walls, ConstPoints points, std::span<const Quad> faces,
                        const Embedding& embedding, int first_hexahedron, int num_hexahedra) {
  return SkinCut(walls, points, faces, embedding, first_hexahedron, num_hexahedra).surface();
}

}  // namespace hexaplast
