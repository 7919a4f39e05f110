// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/hex_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "hexaplast/base/parallel.hpp"
#include "hexaplast/base/require.hpp"
#include "hexaplast/mesh/trilinear.hpp"
#include "mesh/offenders.hpp"

namespace hexaplast {

namespace {

constexpr double kFlatCorner = 1e-6;  // of the mean Jacobian: a corner this flat has no gradient to speak of

/// Whether the map from the reference cube is right side out where the volume is integrated, and no corner is flat.
/// A single corner may be reentrant: its three edges still span the gradient there.
bool is_sound(const ElementPoints& x) {
  bool positive = true;
  for_each_gauss_point(x, [&](const ElementPoints&, const Mat3& J) { positive = positive && J.determinant() > 0; });
  if (!positive) return false;
  const double flat = kFlatCorner * volume(x) / kCorners;
  for (int a = 0; a < kCorners; ++a)
    if (!(std::abs(corner_jacobian(x, a).determinant()) > flat)) return false;
  return true;
}

/// Representative of a node's set in a disjoint-set forest, shortening the path on the way.
int representative(std::vector<int>& parent, int node) {
  while (parent[node] != node) node = parent[node] = parent[parent[node]];
  return node;
}

}  // namespace

HexMesh::HexMesh(PointArray positions, std::vector<Hexahedron> hexahedra)
    : positions_(std::move(positions)), hexahedra_(std::move(hexahedra)) {
  Offenders not_finite, out_of_range, repeated, inverted;
  for (int n = 0; n < num_nodes(); ++n)
    if (!positions_.row(n).allFinite()) not_finite.add(n);
  not_finite.refuse("nodes with a coordinate that is not finite", "coordinates must be finite numbers");

  for (int e = 0; e < num_elements(); ++e) {
    Hexahedron sorted = hexahedra_[e];
    std::sort(sorted.begin(), sorted.end());
    if (sorted.front() < 0 || sorted.back() >= num_nodes()) out_of_range.add(e);
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) repeated.add(e);
  }
  out_of_range.refuse("hexahedra with a node index out of range",
                      fmt::format("indices must lie in [0, {})", num_nodes()).c_str());
  repeated.refuse("hexahedra that name a node twice", "the eight corners must be distinct");

  for (int e = 0; e < num_elements(); ++e) {
    if (!is_sound(gather(positions_, hexahedra_[e]))) inverted.add(e);
  }
  inverted.refuse(
      "inverted, flat or left-handed hexahedra",
      "the Jacobian must be positive at the Gauss points, in the corner order of VTK, and not 0 at a corner");

  first_.assign(num_nodes() + 1, 0);
  for (const Hexahedron& corners : hexahedra_)
    for (const int node : corners) ++first_[node + 1];
  for (int n = 0; n < num_nodes(); ++n) first_[n + 1] += first_[n];

  incidence_.resize(first_[num_nodes()]);
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int e = 0; e < num_elements(); ++e)
    for (int a = 0; a < kCorners; ++a) incidence_[next[hexahedra_[e][a]]++] = {e, a};
}

std::vector<std::array<int, 4>> HexMesh::boundary_faces(std::span<const unsigned char> alive) const {
  struct Face {
    std::array<int, 4> corners;
    int count = 0;
  };
  std::map<std::array<int, 4>, Face> faces;  // by sorted corners
  for (int e = 0; e < num_elements(); ++e) {
    if (!alive.empty() && !alive[e]) continue;
    const Hexahedron& hexahedron = hexahedra_[e];
    for (const auto& local : kFaces) {
      std::array<int, 4> corners, key;
      for (int k = 0; k < 4; ++k) corners[k] = hexahedron[local[k]];
      key = corners;
      std::sort(key.begin(), key.end());
      Face& face = faces[key];
      face.corners = corners;
      ++face.count;
    }
  }
  std::vector<std::array<int, 4>> boundary;
  for (const auto& [key, face] : faces)
    if (face.count == 1) boundary.push_back(face.corners);
  return boundary;
}

ConnectedParts connected_parts(const HexMesh& mesh, std::span<const unsigned char> alive) {
  std::vector<int> parent(mesh.num_nodes());
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<bool> has_element(mesh.num_nodes(), false);
  for (int e = 0; e < mesh.num_elements(); ++e) {
    if (!alive[e]) continue;
    const Hexahedron& corners = mesh.hexahedra()[e];
    for (const int node : corners) {
      parent[representative(parent, node)] = representative(parent, corners[0]);
      has_element[node] = true;
    }
  }

  ConnectedParts parts{std::vector<int>(mesh.num_nodes(), -1), 0};
  std::vector<int> number(mesh.num_nodes(), -1);
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (!has_element[n]) continue;
    int& part = number[representative(parent, n)];
    if (part < 0) part = parts.count++;
    parts.part_of_node[n] = part;
  }
  return parts;
}

void scatter(const HexMesh& mesh, const std::vector<ElementPoints>& corner, Points nodal) {
  require_count("scatter", "corner", std::ssize(corner), mesh.num_elements());
  require_rows("scatter", "nodal", nodal, mesh.num_nodes());
  parallel_for(mesh.num_nodes(), [&](int n) {
    for (const auto& [element, a] : mesh.incident(n)) nodal.row(n) += corner[element].row(a);
  });
}

}  // namespace hexaplast
