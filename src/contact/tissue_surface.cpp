// SPDX-License-Identifier: LGPL-2.1-or-later
#include "contact/tissue_surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hexaplast/mesh/faces.hpp"
#include "mesh/neighbours.hpp"

namespace hexaplast {
namespace {

constexpr double kWithin = 1e-9;        // of a hexahedron's size: a point this near to it lies in it
constexpr double kNoDirection = 1e-6;   // of an edge: nearer to the surface than this, its own normal is taken
constexpr double kSameSide = 0.7;       // cosine, from which a surface that turned is the one that was touched
constexpr double kStraight = 1 - 1e-6;  // cosine, of what lies straight behind a face
constexpr double kCurved = 0.05;        // of an edge: what the triangles of a face differ from it at most
constexpr double kAsNear = 1e-9;        // of a distance, or an edge: rounding must not decide which place is nearer
constexpr int kNearCells = 2;           // a body does not touch itself within
constexpr int kMaxCells = 128;          // of the grid along an axis
constexpr int kMaxWalks = 200;

Eigen::AlignedBox3d box_of(ConstPoints x, std::span<const int> nodes) {
  Eigen::AlignedBox3d box;
  for (const int node : nodes) box.extend(Vec3(x.row(node).transpose()));
  return box;
}

/// items_of: for each of `count` groups, the items that name it.
template <class Groups>
void group(int count, int num_items, const Groups& groups_of, std::vector<int>& first, std::vector<int>& items) {
  first.assign(static_cast<std::size_t>(count) + 1, 0);
  for (int i = 0; i < num_items; ++i)
    for (const int g : groups_of(i)) ++first[g + 1];
  for (int g = 0; g < count; ++g) first[g + 1] += first[g];
  items.resize(first[count]);
  std::vector<int> next(first.begin(), first.end() - 1);
  for (int i = 0; i < num_items; ++i)
    for (const int g : groups_of(i)) items[next[g]++] = i;
}

}  // namespace

TissueSurface::TissueSurface(const HexMesh& mesh, std::span<const unsigned char> alive, bool touches_itself)
    : mesh_(&mesh), across_(neighbours_across_faces(mesh, alive)) {
  for (const BoundaryFace& face : boundary_of(mesh, alive)) {
    faces_.push_back(face.nodes);
    owner_.push_back(face.element);
  }
  for (int e = 0; e < mesh.num_elements(); ++e)
    if (alive.empty() || alive[e]) hexahedra_.push_back(e);

  double sum = 0;
  for (const Quad& face : faces_)
    for (int a = 0; a < 4; ++a) sum += (mesh.positions().row(face[a]) - mesh.positions().row(face[(a + 1) % 4])).norm();
  mean_edge_ = faces_.empty() ? 0 : sum / (4.0 * static_cast<double>(faces_.size()));
  find_thickness();
  for (const int e : hexahedra_) nodes_.insert(nodes_.end(), mesh.hexahedra()[e].begin(), mesh.hexahedra()[e].end());
  std::ranges::sort(nodes_);
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  const auto num_faces = static_cast<int>(faces_.size());
  group(
      mesh.num_nodes(), num_faces, [&](int f) { return faces_[f]; }, first_of_node_, faces_of_node_);
  group(
      mesh.num_elements(), num_faces, [&](int f) { return std::array{owner_[f]}; }, first_of_hexahedron_,
      faces_of_hexahedron_);
  if (touches_itself) find_neighbourhoods(alive);
}

// Edges along an axis of a hexahedron count together: one that is short makes it no thinner.
void TissueSurface::find_thickness() {
  thickness_ = mean_edge_;
  for (const int e : owner_) {
    const Hexahedron& nodes = mesh_->hexahedra()[e];
    Vec3 along = Vec3::Zero();
    for (const auto& [a, b] : kEdges) {
      int axis = 0;
      while (kCornerSign[a][axis] == kCornerSign[b][axis]) ++axis;
      along[axis] += (mesh_->positions().row(nodes[a]) - mesh_->positions().row(nodes[b])).norm() / 4;
    }
    if (const double least = along.minCoeff(); least > 0) thickness_ = std::min(thickness_, least);
  }
}

std::vector<int> TissueSurface::faces_since(const TissueSurface& before, const SplitNodes& split) const {
  std::vector<int> now(before.faces_.size(), -1);
  for (int f = 0; f < num_faces(); ++f) {
    Quad nodes = faces_[f];
    for (int& node : nodes) node = split.before(node);
    if (const int old = before.find_face(nodes); old >= 0) now[old] = f;
  }
  return now;
}

int TissueSurface::find_face(const Quad& nodes) const {
  if (nodes[0] + 1 >= std::ssize(first_of_node_)) return -1;
  const Quad wanted = sorted(nodes);
  for (int k = first_of_node_[nodes[0]]; k < first_of_node_[nodes[0] + 1]; ++k)
    if (sorted(faces_[faces_of_node_[k]]) == wanted) return faces_of_node_[k];
  return -1;
}

void TissueSurface::find_neighbourhoods(std::span<const unsigned char> alive) {
  near_.resize(static_cast<std::size_t>(mesh_->num_nodes()));
  for (int node = 0; node < mesh_->num_nodes(); ++node) {
    if (first_of_node_[node] == first_of_node_[node + 1]) continue;
    std::vector<int>& near = near_[node];
    for (const HexMesh::Incidence& at : mesh_->incident(node))
      if (alive.empty() || alive[at.element]) near.push_back(at.element);
    for (int cell = 0; cell < kNearCells; ++cell) {
      const std::size_t before = near.size();
      for (std::size_t k = 0; k < before; ++k)
        for (const int other : across_[near[k]])
          if (other >= 0) near.push_back(other);
      std::ranges::sort(near);
      near.erase(std::unique(near.begin(), near.end()), near.end());
    }
  }
}

bool TissueSurface::is_near(int hexahedron, std::span<const int> own) const {
  return std::ranges::any_of(own, [&](int node) { return std::ranges::binary_search(near_[node], hexahedron); });
}

/// By so many steps through faces at most.
bool TissueSurface::is_joined(int hexahedron, int other, int steps) const {
  if (hexahedron == other) return true;
  if (steps == 0) return false;
  return std::ranges::any_of(across_[hexahedron],
                             [&](int next) { return next >= 0 && is_joined(next, other, steps - 1); });
}

void TissueSurface::look_at(ConstPoints x, const Eigen::AlignedBox3d& region, double reach) {
  x_.emplace(x);
  boxes_.resize(static_cast<std::size_t>(mesh_->num_elements()));
  counted_.clear();
  box_.setEmpty();
  double extent = 0;
  for (const int e : hexahedra_) {
    Eigen::AlignedBox3d& box = boxes_[e];
    box = box_of(x, mesh_->hexahedra()[e]);
    box.min().array() -= reach;
    box.max().array() += reach;
    if (!box.intersects(region)) continue;
    counted_.push_back(e);
    box_.extend(box);
    extent += box.sizes().maxCoeff();
  }
  if (counted_.empty()) return;
  cell_ = std::max(extent / static_cast<double>(counted_.size()), box_.sizes().maxCoeff() / kMaxCells);
  origin_ = box_.min();
  size_ = (box_.sizes().array() / cell_).cast<int>() + 1;
  const auto cells_of = [&](int i, const auto& visit) { for_each_cell(boxes_[counted_[i]], visit); };
  first_in_cell_.assign(static_cast<std::size_t>(size_.prod()) + 1, 0);
  const auto count = static_cast<int>(counted_.size());
  for (int i = 0; i < count; ++i) cells_of(i, [&](int cell) { ++first_in_cell_[cell + 1]; });
  for (std::size_t cell = 1; cell < first_in_cell_.size(); ++cell) first_in_cell_[cell] += first_in_cell_[cell - 1];
  in_cell_.resize(first_in_cell_.back());
  // filled from the last one on, so that each cell's begin ends where it belongs and its hexahedra ascend
  std::vector<int>& next = first_in_cell_;
  for (int i = count; i-- > 0;) cells_of(i, [&](int cell) { in_cell_[--next[cell + 1]] = counted_[i]; });
  std::rotate(next.begin(), next.begin() + 1, next.end());
  next.back() = static_cast<int>(in_cell_.size());
}

/// The cells of the grid that a box meets.
template <class Visit>
void TissueSurface::for_each_cell(const Eigen::AlignedBox3d& box, const Visit& visit) const {
  const Eigen::Array3i from = ((box.min() - origin_).array() / cell_).cast<int>().max(0),
                       to = ((box.max() - origin_).array() / cell_).cast<int>().min(size_ - 1);
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j)
      for (int l = from[0]; l <= to[0]; ++l) visit((k * size_[1] + j) * size_[0] + l);
}

template <class Visit>
void TissueSurface::for_each_around(const Vec3& p, const Visit& visit) const {
  if (counted_.empty() || !box_.contains(p)) return;
  const Eigen::Array3i at = ((p - origin_).array() / cell_).cast<int>().max(0).min(size_ - 1);
  const int cell = (at[2] * size_[1] + at[1]) * size_[0] + at[0];
  for (int k = first_in_cell_[cell]; k < first_in_cell_[cell + 1]; ++k)
    if (boxes_[in_cell_[k]].contains(p) && !visit(in_cell_[k])) return;
}

/// One of the four triangles between the edges of a face and its middle.
std::array<Vec3, 3> TissueSurface::triangle_of(ConstPoints x, const Quad& face, int k) {
  const Vec3 middle = (x.row(face[0]) + x.row(face[1]) + x.row(face[2]) + x.row(face[3])).transpose() / 4;
  return {x.row(face[k]).transpose(), x.row(face[(k + 1) % 4]).transpose(), middle};
}

/// Of places that are as near as others, the one of the first triangle counts.
bool TissueSurface::is_nearer(const Nearest& found, const Nearest& other) const {
  const double same = kAsNear * (found.place.squared + kAsNear * mean_edge_ * mean_edge_);
  if (std::abs(found.place.squared - other.place.squared) > same) return found.place.squared < other.place.squared;
  return std::pair(found.face, found.triangle) < std::pair(other.face, other.triangle);
}

/// By the box of a face: whether none of its places can be nearer, or as near.
bool TissueSurface::is_farther(int face, const Nearest& than, const Vec3& p) const {
  const double same = 4 * kAsNear * (than.place.squared + kAsNear * mean_edge_ * mean_edge_);
  return box_of(*x_, faces_[face]).squaredExteriorDistance(p) > than.place.squared + same;
}

TissueSurface::Nearest TissueSurface::nearest_on(ConstPoints x, const Quad& face, int index, const Vec3& p) const {
  Nearest nearest = {.face = index, .place = {}, .triangle = 0};
  for (int k = 0; k < 4; ++k) {
    const Nearest found = {.face = index, .place = nearest_place(triangle_of(x, face, k), p), .triangle = k};
    if (is_nearer(found, nearest)) nearest = found;
  }
  return nearest;
}

/// For a point of a hexahedron: from there on, hexahedron by hexahedron. Of places that are as near as others, the one
/// that is reached first counts: the other wall of a cut lies behind the end of the cut.
TissueSurface::Nearest TissueSurface::nearest_initially(const Vec3& p, int hexahedron) const {
  thread_local std::vector<int> reached;  // kept for their memory
  thread_local std::vector<long> known;   // per hexahedron: the latest call that has reached it
  thread_local long call = 0;
  ++call;
  if (known.size() < across_.size()) {
    known.resize(across_.size(), 0);
    reached.reserve(across_.size());
  }
  known[hexahedron] = call;
  reached.assign(1, hexahedron);
  Nearest nearest;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const int e = reached[i];
    const double reach = (1 + kAsNear) * std::sqrt(nearest.place.squared) + kAsNear * mean_edge_;
    if (box_of(mesh_->positions(), mesh_->hexahedra()[e]).exteriorDistance(p) > reach) continue;
    for (int k = first_of_hexahedron_[e]; k < first_of_hexahedron_[e + 1]; ++k) {
      const int f = faces_of_hexahedron_[k];
      const Nearest found = nearest_on(mesh_->positions(), faces_[f], f, p);
      const double same = kAsNear * (found.place.squared + kAsNear * mean_edge_ * mean_edge_);
      if (found.place.squared + same < nearest.place.squared) nearest = found;
    }
    for (const int other : across_[e])
      if (other >= 0 && std::exchange(known[other], call) != call) reached.push_back(other);
  }
  return nearest;
}

/// To the nearest place of the present surface, from face to face. side: only over faces that face that way. Around the
/// end of a cut, the sample's own wall is nearer than the other one.
TissueSurface::Nearest TissueSurface::walk(int face, const Vec3& p, std::span<const int> own,
                                           const std::optional<Vec3>& side) const {
  Nearest nearest = nearest_on(*x_, faces_[face], face, p);
  for (int walked = 0; walked < kMaxWalks; ++walked) {
    const int from = nearest.face;
    for (const int node : faces_[from])
      for (int k = first_of_node_[node]; k < first_of_node_[node + 1]; ++k) {
        const int other = faces_of_node_[k];
        if (other == from || is_farther(other, nearest, p)) continue;
        if (side && !(normal_of(other).dot(*side) > kSameSide)) continue;
        const Nearest found = nearest_on(*x_, faces_[other], other, p);
        if (is_nearer(found, nearest) && !is_left_out(other, own)) nearest = found;
      }
    if (nearest.face == from) break;
  }
  return nearest;
}

/// Of the whole face, outwards.
Vec3 TissueSurface::normal_of(int face) const {
  const auto corner = [&](int k) -> Vec3 { return x_->row(faces_[face][k]).transpose(); };
  return (corner(2) - corner(0)).cross(corner(3) - corner(1)).normalized();
}

TissueSurface::Place TissueSurface::place_at(const Nearest& nearest, const Vec3& p, bool is_inside) const {
  Place place;
  place.face = nearest.face;
  const double distance = std::sqrt(nearest.place.squared);
  place.distance = is_inside ? -distance : distance;
  const auto [a, b, c] = triangle_of(*x_, faces_[nearest.face], nearest.triangle);
  const Vec3 across = (b - a).cross(c - a);
  const bool is_on_face = nearest.place.feature == TrianglePlace::kFace || distance < kNoDirection * mean_edge_;
  if (!is_on_face) {
    place.normal = (p - nearest.place.place) / place.distance;
    return place;
  }
  place.normal = across.norm() > 0 ? Vec3(across.normalized()) : normal_of(nearest.face);
  // the triangles are the surface, also for a point between them and the face that they stand for
  if (distance < kCurved * mean_edge_) place.distance = place.normal.dot(p - nearest.place.place);
  return place;
}

/// To the nearest place for a point inside that has touched `face`. Near an edge, or in a thin body, that may lie on
/// another side: as long as the point lies behind its own one, it stays there.
TissueSurface::Nearest TissueSurface::on_its_side(const Side& side, const Vec3& p, std::span<const int> own) const {
  const Nearest nearest = walk(side.face, p, own);
  const Vec3 normal = normal_of(side.face), of_nearest = place_at(nearest, p, true).normal;
  if (of_nearest.dot(normal) > kSameSide || faces_more(of_nearest, normal, side.outwards)) return nearest;
  const Nearest on_side = walk(side.face, p, own, normal);
  return place_at(on_side, p, true).normal.dot(normal) > kSameSide ? on_side : nearest;
}

void TissueSurface::turn_to_facing(Place& place, const Vec3& p, const Vec3& outwards, std::span<const int> own) const {
  const double same = kNoDirection * mean_edge_;
  if (!(std::abs(place.distance) < same)) return;
  const Quad from = faces_[place.face];
  for (const int node : from)
    for (int k = first_of_node_[node]; k < first_of_node_[node + 1]; ++k) {
      const int f = faces_of_node_[k];
      if (f == place.face || (!own.empty() && !is_joined(place.hexahedron, owner_[f]))) continue;
      if (!faces_more(normal_of(f), place.normal, outwards) || is_left_out(f, own)) continue;
      const Nearest found = nearest_on(*x_, faces_[f], f, p);
      if (!(found.place.squared < same * same)) continue;
      const Place facing = place_at(found, p, place.distance < 0);
      place.face = f;
      place.normal = facing.normal;
      place.distance = facing.distance;
    }
}

/// Beyond what the triangles of a face differ from it.
bool TissueSurface::is_in_front(const Nearest& nearest, const Vec3& p) const {
  const auto [a, b, c] = triangle_of(*x_, faces_[nearest.face], nearest.triangle);
  return (b - a).cross(c - a).normalized().dot(p - nearest.place.place) > kCurved * mean_edge_;
}

void TissueSurface::turn_to_entry(Place& place, const Vec3& p, const Vec3& change, const Side& side,
                                  std::span<const int> own) const {
  if (!(place.distance < 0) || counted_.empty()) return;
  Eigen::AlignedBox3d way;
  way.extend(p);
  way.extend(Vec3(p - change));
  Place entry = place;
  double since = 1 + kAsNear;  // of the way, that has passed since then: the latest entry counts
  std::pair<int, int> of(-1, -1);
  for_each_cell(way, [&](int cell) {
    for (int i = first_in_cell_[cell]; i < first_in_cell_[cell + 1]; ++i) {
      const int e = in_cell_[i];
      if (!boxes_[e].intersects(way) || (!own.empty() && (is_near(e, own) || !is_joined(place.hexahedron, e))))
        continue;
      for (int j = first_of_hexahedron_[e]; j < first_of_hexahedron_[e + 1]; ++j) {
        const int f = faces_of_hexahedron_[j];
        for (int k = 0; k < 4; ++k) {
          const std::array<Vec3, 3> corners = triangle_of(*x_, faces_[f], k);
          const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
          const double along = across.dot(change), depth = -across.dot(p - corners[0]);
          if (!(along < 0) || !(depth >= 0)) continue;  // not inwards
          const double at = -depth / along;
          const bool is_as_late = of.first >= 0 && std::abs(at - since) <= kAsNear;
          if (is_as_late ? of < std::pair(f, k) : !(at < since)) continue;
          const Vec3 crossed = p - at * change;
          bool is_within = true;
          for (int a = 0; a < 3; ++a) {
            const Vec3 edge = corners[(a + 1) % 3] - corners[a];
            is_within = is_within && across.dot(edge.cross(crossed - corners[a])) >= -kAsNear * across.squaredNorm();
          }
          if (!is_within) continue;
          since = at;
          of = {f, k};
          entry.face = f;
          entry.normal = across.normalized();
          entry.distance = -depth / across.norm();
        }
      }
    }
  });
  if (of.first < 0) {  // it was inside already
    Side inside = side;
    if (inside.face < 0) {
      const std::optional<Place> before = find(p - change, {}, 0, own);
      if (!before || !(before->distance < 0)) return;
      inside.face = before->face;
    }
    const Place on_side = place_at(on_its_side(inside, p, own), p, true);
    entry.face = on_side.face;
    entry.normal = on_side.normal;
    entry.distance = on_side.distance;
  }
  if (!(entry.normal.dot(place.normal) > kSameSide) && !faces_more(place.normal, entry.normal, side.outwards))
    place = entry;
}

bool TissueSurface::is_clear(const Vec3& p, double reach, std::span<const int> own) const {
  bool is_clear = true;
  for_each_around(p, [&](int e) {
    if (own.empty() || !is_near(e, own)) {
      const double size = boxes_[e].diagonal().norm();
      is_clear = !(nearest_place(gather(*x_, mesh_->hexahedra()[e]), p, size).distance < reach);
    }
    return is_clear;
  });
  return is_clear;
}

std::optional<TissueSurface::Place> TissueSurface::find(const Vec3& p, const Side& side, double reach,
                                                        std::span<const int> own) const {
  int inside = -1, face = side.face;
  HexahedronPlace at;
  Nearest in_front;
  for_each_around(p, [&](int e) {
    if (!own.empty() && is_near(e, own)) return true;
    const ElementPoints corners = gather(*x_, mesh_->hexahedra()[e]);
    const double size = boxes_[e].diagonal().norm();
    const HexahedronPlace place = nearest_place(corners, p, size);
    if (place.distance <= kWithin * size) {
      inside = e;
      at = place;
      return false;
    }
    if (place.distance < reach)
      for (int k = first_of_hexahedron_[e]; k < first_of_hexahedron_[e + 1]; ++k) {
        const int f = faces_of_hexahedron_[k];
        if (is_farther(f, in_front, p)) continue;
        const Nearest found = nearest_on(*x_, faces_[f], f, p);
        if (is_nearer(found, in_front)) in_front = found;
      }
    return true;
  });
  if (inside >= 0) {
    const auto nearest = [&] {
      if (face >= 0) return on_its_side(side, p, own);
      const Vec3 initial = gather(mesh_->positions(), mesh_->hexahedra()[inside]).transpose() * shape_functions(at.s);
      const Nearest initially = nearest_initially(initial, inside);
      return initially.face >= 0 ? walk(initially.face, p, own) : initially;
    }();
    if (nearest.face < 0) return std::nullopt;
    const bool is_another = !own.empty() && !is_joined(inside, owner_[nearest.face]);
    if (face < 0 || !(is_another || is_in_front(nearest, p))) {  // else it is in another one than those of its side
      Place place = place_at(nearest, p, true);
      place.hexahedron = inside;
      place.weights = weights_beyond(gather(*x_, mesh_->hexahedra()[inside]), at.s, p, kFarthestBeyond);
      return place;
    }
  }
  if (face < 0) face = in_front.face;
  if (face < 0) return std::nullopt;
  std::optional<Place> behind;  // what it touched, and out of the body on the other side: that is thin
  if (side.face >= 0) {
    const Nearest on_side = walk(face, p, own, normal_of(face));
    const Vec3 normal = normal_of(on_side.face);
    if (normal.dot(p - on_side.place.place) < 0) behind = place_at(on_side, p, true);
    if (behind && !(behind->normal.dot(normal) > kStraight)) behind.reset();
  }
  Place place = behind ? *behind : place_at(walk(face, p, own), p, false);
  if (!(std::abs(place.distance) < reach)) return std::nullopt;
  if (side.face >= 0 && !(place.normal.dot(normal_of(side.face)) > kSameSide)) return std::nullopt;
  place.hexahedron = owner_[place.face];
  if (!own.empty() && is_near(place.hexahedron, own)) return std::nullopt;
  const ElementPoints corners = gather(*x_, mesh_->hexahedra()[place.hexahedron]);
  place.weights = weights_beyond(corners, nearest_place(corners, p, mean_edge_).s, p, kFarthestBeyond);
  return place;
}

}  // namespace hexaplast
