// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/skin_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "mesh/selection.hpp"

namespace hexaplast {
namespace {

using Lip = DividedSkin::Lip;

/// Walls are on copies of nodes.
class SkinWalls {
 public:
  SkinWalls(const CutWalls& walls, int first_hexahedron, int num_hexahedra, DividedSkin& skin)
      : walls_(walls), first_(first_hexahedron), num_(num_hexahedra), skin_(skin), num_faces_(skin.faces.size()) {}

  void add() {
    find_walls();
    end_lips();
    add_strips();
    add_walls();
  }

 private:
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
  DividedSkin& skin_;
  const std::size_t num_faces_;  // of the skin
  std::vector<WallFace> wall_faces_;
  std::map<int, int> initial_;                // of copies on walls
  std::set<int> is_front_;                    // copies that the walls on both sides of a face have
  std::map<int, std::vector<int>> beside_;    // along edges of walls, by initial nodes
  std::map<int, std::pair<Vec3, int>> pull_;  // by initial node: sum of places on lips, and how many
  std::map<Edge, int> joined_;                // edges of walls along strips: how often
  std::vector<std::pair<Triangle, std::array<bool, 3>>> strips_;  // which corners are copies
};

void SkinWalls::find_walls() {
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
std::vector<Edge> SkinWalls::way(const Edge& from, const std::function<bool(const Edge&)>& is_goal) const {
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
void SkinWalls::end_lips() {
  std::map<int, int> end_of;  // point of the skin
  const auto end = [&](int point, int copy) {
    if (const auto found = end_of.find(point); found != end_of.end()) return found->second;
    const std::vector<Edge> found = way({copy, copy}, [&](const Edge& other) { return is_front_.contains(other[0]); });
    return end_of[point] = found.empty() ? -1 : found.back()[0];
  };
  for (Lip& lip : skin_.lips) {
    if (lip.copy_from < 0) lip.copy_from = end(lip.from, lip.copy_to);
    if (lip.copy_to < 0) lip.copy_to = end(lip.to, lip.copy_from);
  }
}

/// Strips across each other run along the same initial nodes where both sides have such a way.
void SkinWalls::add_strips() {
  for (std::size_t l = 0; l < skin_.lips.size(); l += 2) {
    const Lip &lip = skin_.lips[l], &across = skin_.lips[l + 1];
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

void SkinWalls::add_strip(const Lip& lip, const std::vector<int>& nodes, bool is_across) {
  if (nodes.empty()) return;
  strips_.push_back({{lip.to, lip.from, is_across ? nodes.back() : nodes[0]}, {false, false, true}});
  for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
    strips_.push_back({{is_across ? lip.from : lip.to, nodes[k], nodes[k + 1]}, {false, true, true}});
    ++joined_[sorted(Edge{nodes[k], nodes[k + 1]})];
  }
  const auto pull = [&](int copy, double at) {
    auto& [sum, count] = pull_.try_emplace(initial_.at(copy), Vec3::Zero(), 0).first->second;
    sum += skin_.points[lip.from] + at * (skin_.points[lip.to] - skin_.points[lip.from]);
    ++count;
  };
  const double last = std::max(1.0, static_cast<double>(nodes.size()) - 1);
  for (std::size_t k = 0; k < nodes.size(); ++k) pull(nodes[k], static_cast<double>(k) / last);
  if (nodes.size() == 1) pull(nodes[0], 1);
}

/// Whether a place lies within the skin.
bool SkinWalls::winds_around(const Vec3& place) const {
  double angle = 0;
  for (const auto& [p, q, r] : skin_.triangles)
    angle += solid_angle(skin_.points[p] - place, skin_.points[q] - place, skin_.points[r] - place);
  return std::abs(angle) > 2 * std::numbers::pi;
}

/// Per face of a wall, whether it lies within the skin, with the walls on its other sides: strips and walls together
/// have an even number of faces at each edge. Beyond an edge that one wall alone has lies the outside of all hexahedra.
std::vector<unsigned char> SkinWalls::inside() const {
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

void SkinWalls::add_walls() {
  std::map<int, int> point_of;  // copies
  const auto point = [&](int copy) {
    const auto [entry, is_new] = point_of.emplace(copy, -1);
    if (!is_new) return entry->second;
    const int initial = initial_.at(copy);
    const CutWalls::Node& node = *walls_.node(initial);
    const auto pulled = pull_.find(initial);
    const Vec3 place = pulled == pull_.end() ? node.place : Vec3(pulled->second.first / pulled->second.second);
    return entry->second = skin_.add_point(place, walls_.carrier(node, copy, place));
  };
  for (const auto& [corners, are_copies] : strips_) {
    Triangle triangle = corners;
    for (int k = 0; k < 3; ++k)
      if (are_copies[k]) triangle[k] = point(corners[k]);
    skin_.faces.push_back({triangle[0], triangle[1], triangle[2], triangle[2]});
  }
  const std::vector<unsigned char> is_inside = inside();
  for (std::size_t f = 0; f < wall_faces_.size(); ++f) {
    if (!is_inside[f]) continue;
    Quad quad = wall_faces_[f].copies;
    for (int& corner : quad) corner = point(corner);
    skin_.faces.push_back(quad);
  }
  fill_holes();
}

/// Where lips end at nodes from which no wall leads on, as at a notch of the hexahedra, edges of lips, strips and walls
/// have an odd number of faces: these form rings, which fans fill. Where the skin was open before, it stays so.
void SkinWalls::fill_holes() {
  std::map<Edge, std::pair<int, int>> faces_at;  // how many, and how many more run up along it
  const auto add_edge = [&](int from, int to) {
    if (from == to) return;
    auto& [count, up] = faces_at[sorted(Edge{from, to})];
    ++count;
    up += from < to ? 1 : -1;
  };
  for (const Lip& lip : skin_.lips) add_edge(lip.from, lip.to);
  for (const Quad& face : std::span(skin_.faces).subspan(num_faces_))  // behind those of the skin
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
        skin_.faces.push_back({corners[0], corners[k], corners[k + 1], corners[k + 1]});
    }
  }
}

}  // namespace

void add_walls(const CutWalls& walls, int first_hexahedron, int num_hexahedra, DividedSkin& skin) {
  SkinWalls(walls, first_hexahedron, num_hexahedra, skin).add();
}

}  // namespace hexaplast
