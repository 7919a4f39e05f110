// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/hex_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/disjoint_sets.hpp"
#include "base/require.hpp"
#include "hexaplast/base/parallel.hpp"
#include "mesh/copies.hpp"
#include "mesh/neighbours.hpp"
#include "mesh/offenders.hpp"
#include "mesh/trilinear.hpp"

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

}  // namespace

void require_own_nodes(std::span<const Hexahedron> hexahedra) {
  std::vector<Hexahedron> nodes(hexahedra.begin(), hexahedra.end());
  for (Hexahedron& of_element : nodes) of_element = sorted(of_element);
  const std::vector<int> first = first_copies<Hexahedron>(nodes);
  Offenders copies;
  for (int e = 0; e < static_cast<int>(first.size()); ++e)
    if (first[e] != e) copies.add(e, first[e]);
  copies.refuse("hexahedra with the same eight nodes as another one", "each must be given once");
}

HexMesh::HexMesh(PointArray positions, std::vector<Hexahedron> hexahedra)
    : positions_(std::move(positions)), hexahedra_(std::move(hexahedra)) {
  Offenders not_finite, out_of_range, repeated, inverted;
  for (int n = 0; n < num_nodes(); ++n)
    if (!positions_.row(n).allFinite()) not_finite.add(n);
  not_finite.refuse("nodes with a coordinate that is not finite", "coordinates must be finite numbers");

  for (int e = 0; e < num_elements(); ++e) {
    const Hexahedron nodes = sorted(hexahedra_[e]);
    if (nodes.front() < 0 || nodes.back() >= num_nodes()) out_of_range.add(e);
    if (std::ranges::adjacent_find(nodes) != nodes.end()) repeated.add(e);
  }
  out_of_range.refuse("hexahedra with a node index out of range",
                      fmt::format("indices must lie in [0, {})", num_nodes()).c_str());
  repeated.refuse("hexahedra that name a node twice", "the eight corners must be distinct");
  require_own_nodes(hexahedra_);

  for (int e = 0; e < num_elements(); ++e) {
    if (!is_sound(gather(positions_, hexahedra_[e]))) inverted.add(e);
  }
  inverted.refuse(
      "inverted, flat or left-handed hexahedra",
      "the Jacobian must be positive at the Gauss points, in the corner order of VTK, and not 0 at a corner");

  find_incidence();
}

HexMesh::HexMesh(const HexMesh& other, std::span<const int> node, std::vector<Hexahedron> hexahedra)
    : positions_(static_cast<Eigen::Index>(node.size()), 3), hexahedra_(std::move(hexahedra)) {
  for (int n = 0; n < num_nodes(); ++n) positions_.row(n) = other.positions_.row(node[n]);
  find_incidence();
}

void HexMesh::find_incidence() {
  first_.assign(num_nodes() + 1, 0);
  for (const Hexahedron& corners : hexahedra_)
    for (const int node : corners) ++first_[node + 1];
  for (int n = 0; n < num_nodes(); ++n) first_[n + 1] += first_[n];

  incidence_.resize(first_[num_nodes()]);
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int e = 0; e < num_elements(); ++e)
    for (int a = 0; a < kCorners; ++a) incidence_[next[hexahedra_[e][a]]++] = {e, a};
}

const std::vector<std::array<int, 6>>& HexMesh::neighbours() const {
  std::call_once(neighbours_->found, [&] { neighbours_->across = neighbours_across_faces(hexahedra_); });
  return neighbours_->across;
}

std::vector<Quad> HexMesh::boundary_faces(std::span<const unsigned char> alive) const {
  std::vector<Quad> faces;
  for (const BoundaryFace& face : boundary_of(*this, alive)) faces.push_back(face.nodes);
  return faces;
}

ConnectedParts connected_parts(const HexMesh& mesh, std::span<const unsigned char> alive) {
  require_count("connected_parts", "alive", std::ssize(alive), mesh.num_elements());
  DisjointSets sets(mesh.num_nodes());
  std::vector<bool> has_element(mesh.num_nodes(), false);
  for (int e = 0; e < mesh.num_elements(); ++e) {
    if (!alive[e]) continue;
    const Hexahedron& corners = mesh.hexahedra()[e];
    for (const int node : corners) {
      sets.join(corners[0], node);
      has_element[node] = true;
    }
  }

  ConnectedParts parts{std::vector<int>(mesh.num_nodes(), -1), 0};
  std::vector<int> number(mesh.num_nodes(), -1);
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (!has_element[n]) continue;
    int& part = number[sets.root(n)];
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
