// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/cut_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>
#include <set>

#include "base/require.hpp"
#include "geometry/nearest_place.hpp"

namespace hexaplast {
namespace {

constexpr double kFlat = 0.15;         // least spread of crossings that lie on a plane, in parts of the next larger one
constexpr double kFaceNormals = 1e-3;  // weight of the faces' normals, which decide where crossings lie on a line
constexpr double kOneDirection = 0.1;  // part of a surface's normals across which it counts as flat
constexpr double kSoft = 1e-3;         // keeps nodes from going far along a surface that the cut hardly crosses
constexpr double kFarthest = 0.8;      // that a node moves, in links

Vec3 centre_of(const HexMesh& mesh, int e) {
  return gather(mesh.positions(), mesh.hexahedra()[e]).colwise().mean().transpose();
}

}  // namespace

OpenFaces open_faces(const Joints& joints, const NodeCopies& copies, std::span<const int> opened,
                     std::span<const double> crossings, int num_hexahedra) {
  require_count("open_faces", "crossings", std::ssize(crossings), std::ssize(opened));
  OpenFaces open{copies.initial(), std::vector<int>(copies.initial().size()), {}};
  std::iota(open.copy.begin(), open.copy.end(), 0);
  std::array<double, 6> closed;
  closed.fill(-1);
  open.crossing.assign(static_cast<std::size_t>(num_hexahedra), closed);
  for (std::size_t k = 0; k < opened.size(); ++k) {
    if (opened[k] >= joints.num_faces()) continue;
    const std::span<const int> held = joints.hexahedra(opened[k]);
    for (const int e : held) {
      const auto side = std::ranges::find(joints.across(e), opened[k]) - joints.across(e).begin();
      open.crossing[e][side] = e == held.front() ? crossings[k] : 1 - crossings[k];
    }
  }
  return open;
}

struct CutWalls::Face {
  Quad initial;         // nodes, around it
  Vec3 crossing, link;  // [m]
};

CutWalls::CutWalls(const HexMesh& mesh, const OpenFaces& open, std::span<const unsigned char> alive)
    : mesh_(mesh), open_(open), is_wall_(mesh.num_elements()) {
  require_count("CutWalls", "initial_node", std::ssize(open.initial_node), mesh.num_nodes());
  require_count("CutWalls", "copy", std::ssize(open.copy), mesh.num_nodes());
  require_count("CutWalls", "crossing", std::ssize(open.crossing), mesh.num_elements());
  if (!alive.empty()) require_count("CutWalls", "alive", std::ssize(alive), mesh.num_elements());
  const std::vector<Face> faces = find_faces();
  for (const Face& face : faces) mean_link_ += face.link.norm() / static_cast<double>(faces.size());
  find_nodes(faces, alive);
}

int CutWalls::initial_node(int hexahedron, int corner) const {
  return open_.initial_node[mesh_.hexahedra()[hexahedron][corner]];
}

int CutWalls::copy(int hexahedron, int corner) const { return open_.copy[mesh_.hexahedra()[hexahedron][corner]]; }

int CutWalls::copy_at(int hexahedron, int initial) const {
  for (int a = 0; a < kCorners; ++a)
    if (initial_node(hexahedron, a) == initial) return copy(hexahedron, a);
  return -1;
}

bool CutWalls::is_wall(int hexahedron, const Quad& nodes) const {
  for (int side = 0; side < 6; ++side)
    if (is_wall_[hexahedron][side] != 0 && face_of(mesh_.hexahedra()[hexahedron], kFaces[side]) == nodes) return true;
  return false;
}

const CutWalls::Node* CutWalls::node(int initial) const {
  const auto found = nodes_.find(initial);
  return found == nodes_.end() ? nullptr : &found->second;
}

/// Open faces that part nodes, and the walls on their sides.
std::vector<CutWalls::Face> CutWalls::find_faces() {
  struct Side {
    Quad initial, copies;  // sorted
    Wall face;
  };
  std::vector<Side> sides;
  for (int e = 0; e < mesh_.num_elements(); ++e)
    for (int side = 0; side < 6; ++side) {
      if (open_.crossing[e][side] < 0) continue;
      Side& open = sides.emplace_back(Side{{}, {}, {e, side}});
      for (int k = 0; k < 4; ++k) {
        open.initial[k] = initial_node(e, kFaces[side][k]);
        open.copies[k] = copy(e, kFaces[side][k]);
      }
      open.initial = sorted(open.initial);
      open.copies = sorted(open.copies);
    }
  std::ranges::stable_sort(sides, {}, &Side::initial);

  std::vector<Face> faces;
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].initial == sides[first].initial) ++end;
    if (end - first < 2) continue;
    bool is_any_wall = false;
    for (std::size_t k = first; k < end; ++k) {
      const auto of_face = std::span(sides).subspan(first, end - first);
      if (std::ranges::count(of_face, sides[k].copies, &Side::copies) > 1) continue;
      walls_.push_back(sides[k].face);
      is_wall_[sides[k].face.hexahedron][sides[k].face.side] = 1;
      is_any_wall = true;
    }
    if (!is_any_wall) continue;
    const Wall& lowest = sides[first].face;
    const Vec3 from = centre_of(mesh_, lowest.hexahedron);
    Face& face = faces.emplace_back();
    face.link = centre_of(mesh_, sides[first + 1].face.hexahedron) - from;
    face.crossing = from + open_.crossing[lowest.hexahedron][lowest.side] * face.link;
    for (int k = 0; k < 4; ++k) face.initial[k] = initial_node(lowest.hexahedron, kFaces[lowest.side][k]);
  }
  return faces;
}

void CutWalls::find_nodes(std::span<const Face> faces, std::span<const unsigned char> alive) {
  std::map<int, std::vector<int>> own;      // faces at an initial node
  std::map<int, std::set<int>> neighbours;  // along edges of these
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 4; ++k) {
      const int one = faces[f].initial[k], next = faces[f].initial[(k + 1) % 4];
      own[one].push_back(static_cast<int>(f));
      neighbours[one].insert(next);
      neighbours[next].insert(one);
    }
  std::map<int, Vec3> at;
  for (int n = 0; n < mesh_.num_nodes(); ++n) {
    const int initial = open_.initial_node[n];
    if (!own.contains(initial)) continue;
    Node& node = nodes_[initial];
    at[initial] = mesh_.positions().row(n).transpose();
    const std::span<const HexMesh::Incidence> all = mesh_.incident(n);
    const auto is_left = [&](const HexMesh::Incidence& corner) { return alive.empty() || alive[corner.element] != 0; };
    const bool is_any_left = std::ranges::any_of(all, is_left);
    for (const HexMesh::Incidence& corner : all) {
      if (is_left(corner) || !is_any_left) node.incident.push_back(corner);
      node.copies.push_back(open_.copy[n]);
    }
  }
  for (auto& [initial, node] : nodes_) {
    std::ranges::sort(node.incident, {}, &HexMesh::Incidence::element);
    std::ranges::sort(node.copies);
    node.copies.erase(std::unique(node.copies.begin(), node.copies.end()), node.copies.end());
  }
  for (auto& [initial, node] : nodes_) {
    std::vector<int> around = own[initial];
    if (node.copies.size() <= 2)  // where sheets meet, each has a plane of its own
      for (const int other : neighbours[initial])
        if (nodes_[other].copies.size() <= 2) around.insert(around.end(), own[other].begin(), own[other].end());
    std::ranges::sort(around);
    around.erase(std::unique(around.begin(), around.end()), around.end());
    fit(node, at[initial], faces, own[initial], around);
  }
}

/// The node goes to the plane of the crossings around it, along the surface that it lies on.
void CutWalls::fit(Node& node, const Vec3& at, std::span<const Face> faces, const std::vector<int>& own,
                   const std::vector<int>& around) const {
  Vec3 own_middle = Vec3::Zero();
  for (const int f : own) own_middle += faces[f].crossing / static_cast<double>(own.size());
  node.middle = Vec3::Zero();
  for (const int f : around) node.middle += faces[f].crossing / static_cast<double>(around.size());
  Mat3 spread = Mat3::Zero();
  double scale = 0;
  for (const int f : around) {
    const Vec3 from_middle = faces[f].crossing - node.middle, along = faces[f].link.normalized();
    spread += from_middle * from_middle.transpose();
    spread -= kFaceNormals * faces[f].link.squaredNorm() * along * along.transpose();
    scale += faces[f].link.squaredNorm();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
  const bool is_plane =
      node.copies.size() <= 2 && axes.eigenvalues()[0] <= std::max(kFlat * axes.eigenvalues()[1], kFaceNormals * scale);
  const Mat3 tangents = outer_tangents(node);
  Vec3 move = tangents * (own_middle - at);
  if (is_plane) {
    node.normal = axes.eigenvectors().col(0);
    const Vec3 along = tangents * node.normal;
    move = node.normal.dot(node.middle - at) / (along.squaredNorm() + kSoft) * along;
    Vec3 towards = Vec3::Zero();  // the second copy
    for (const auto& [e, corner] : node.incident)
      towards += (copy(e, corner) == node.copies.front() ? -1 : 1) * (centre_of(mesh_, e) - at);
    if (towards.dot(node.normal) < 0) node.normal = -node.normal;
  }
  const double farthest = kFarthest * mean_link_;
  if (move.norm() > farthest) move *= farthest / move.norm();
  node.place = at + move;
}

/// Projects on the directions in which a node may move within the body's outer surface: all, inside.
Mat3 CutWalls::outer_tangents(const Node& node) const {
  std::map<Quad, Vec3> free;  // faces that one hexahedron has, by sorted initial nodes
  std::map<Quad, int> count;
  for (const auto& [e, corner] : node.incident)
    for (const auto& face : kFaces) {
      if (std::ranges::find(face, corner) == face.end()) continue;
      const Quad nodes = face_of(mesh_.hexahedra()[e], face);
      Quad initial;
      std::ranges::transform(nodes, initial.begin(), [&](int n) { return open_.initial_node[n]; });
      initial = sorted(initial);
      const auto x = [&](int k) -> Vec3 { return mesh_.positions().row(nodes[k]).transpose(); };
      free[initial] = (x(2) - x(0)).cross(x(3) - x(1));
      ++count[initial];
    }
  Mat3 normals = Mat3::Zero();
  double area = 0;
  for (const auto& [face, normal] : free) {
    if (count[face] > 1 || !(normal.norm() > 0)) continue;
    normals += normal * normal.transpose() / normal.norm();
    area += normal.norm();
  }
  if (area == 0) return Mat3::Identity();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(normals / area);
  Mat3 tangents = Mat3::Zero();
  for (int k = 0; k < 3; ++k)
    if (axes.eigenvalues()[k] < kOneDirection) {
      const Vec3 along = axes.eigenvectors().col(k);
      tangents += along * along.transpose();
    }
  return tangents;
}

int CutWalls::carrier(const Node& node, int copy_of_node, const Vec3& place) const {
  int nearest = -1;
  double distance = 0;
  for (const auto& [e, corner] : node.incident) {
    if (copy(e, corner) != copy_of_node) continue;
    const ElementPoints x = gather(mesh_.positions(), mesh_.hexahedra()[e]);
    const double away = nearest_place(x, place, (x.row(6) - x.row(0)).norm()).distance;
    if (nearest >= 0 && away >= distance) continue;
    nearest = e;
    distance = away;
  }
  return nearest;
}

WallVertices wall_vertices(const CutWalls& walls) {
  WallVertices vertices;
  std::vector<Vec3> points;
  std::set<int> known;
  for (const auto& [initial, node] : walls.nodes())
    for (const auto& [e, corner] : node.incident) {
      const int n = walls.mesh().hexahedra()[e][corner];
      if (!known.insert(n).second) continue;
      vertices.node.push_back(n);
      points.push_back(node.place);
      vertices.hexahedron.push_back(walls.carrier(node, walls.copy(e, corner), node.place));
    }
  vertices.points.resize(std::ssize(points), 3);
  for (std::size_t k = 0; k < points.size(); ++k)
    vertices.points.row(static_cast<Eigen::Index>(k)) = points[k].transpose();
  return vertices;
}

}  // namespace hexaplast
