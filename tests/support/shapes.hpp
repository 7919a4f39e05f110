// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/geometry/grid.hpp"
#include "kinematics/polar.hpp"
#include "support/random.hpp"

namespace hexaplast::support {

/// Corners of the cube [-1, 1]^3 times half the edge.
inline ElementPoints cube(double edge) {
  ElementPoints x;
  for (int a = 0; a < kCorners; ++a) {
    x.row(a) << kCornerSign[a][0] * edge / 2, kCornerSign[a][1] * edge / 2, kCornerSign[a][2] * edge / 2;
  }
  return x;
}

/// A cube whose corners are moved by up to `fraction` of its edge: no two edges parallel.
inline ElementPoints distorted_hexahedron(double edge, double fraction, std::uint64_t seed) {
  Random random(seed);
  ElementPoints x = cube(edge);
  for (int a = 0; a < kCorners; ++a) x.row(a) += random.vector(fraction * edge).transpose();
  return x;
}

/// One hexahedron as a mesh.
inline HexMesh single_element(const ElementPoints& x) {
  return HexMesh(PointArray(x), {Hexahedron{0, 1, 2, 3, 4, 5, 6, 7}});
}

/// Block of cubes with its smallest corner at the origin.
inline HexMesh block(std::array<int, 3> cells, double edge) {
  return regular_grid(cells, Vec3::Zero(), Vec3(cells[0] * edge, cells[1] * edge, cells[2] * edge));
}

/// The same with every node moved by up to `fraction` of the edge.
inline HexMesh distorted_block(std::array<int, 3> cells, double edge, double fraction, std::uint64_t seed) {
  const HexMesh regular = block(cells, edge);
  Random random(seed);
  return HexMesh(regular.positions() + random.field(regular.num_nodes(), fraction * edge), regular.hexahedra());
}

/// The rotation by |w| [rad] about w.
inline Mat3 rotation_exp(const Vec3& w) { return Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix(); }

/// A x + b for every row x.
template <class Rows>
Rows mapped(const Rows& x, const Mat3& A, const Vec3& b = Vec3::Zero()) {
  return (x * A.transpose()).rowwise() + b.transpose();
}

/// Two meshes in one, the nodes and hexahedra of the second one behind.
inline HexMesh joined(const HexMesh& a, const HexMesh& b) {
  PointArray positions(a.num_nodes() + b.num_nodes(), 3);
  positions << a.positions(), b.positions();
  std::vector<Hexahedron> hexahedra = a.hexahedra();
  for (Hexahedron corners : b.hexahedra()) {
    for (int& n : corners) n += a.num_nodes();
    hexahedra.push_back(corners);
  }
  return HexMesh(positions, hexahedra);
}

inline HexMesh shifted(const HexMesh& mesh, const Vec3& by) {
  return HexMesh(mapped(mesh.positions(), Mat3::Identity(), by), mesh.hexahedra());
}

/// Two copies of a mesh in one, the second `gap` [m] beside the first.
inline HexMesh two_copies(const HexMesh& one, double gap) { return joined(one, shifted(one, Vec3(gap, 0, 0))); }

/// Volume inside a closed surface whose faces look outwards, quads as two triangles each.
template <class Face>
double enclosed_volume(const PointArray& x, const std::vector<Face>& faces) {
  double sum = 0;
  for (const Face& face : faces)
    for (std::size_t k = 2; k < face.size(); ++k)
      sum += Vec3(x.row(face[0])).dot(Vec3(x.row(face[k - 1])).cross(Vec3(x.row(face[k]))));
  return sum / 6;
}

/// Greatest distance of two shapes along an axis after the best rigid motion: averaging fixes the mean, and the turn
/// only loosely.
inline double incongruence(const PointArray& x, const PointArray& expected) {
  const PointArray from = x.rowwise() - x.colwise().mean(), to = expected.rowwise() - expected.colwise().mean();
  return (mapped(from, polar(to.transpose() * from).R) - to).cwiseAbs().maxCoeff();
}

/// Nodes whose initial coordinate along `axis` lies within `reach` of `value`.
inline std::vector<int> nodes_at(const HexMesh& mesh, int axis, double value, double reach = 1e-9) {
  std::vector<int> nodes;
  for (int n = 0; n < mesh.num_nodes(); ++n) {
    if (std::abs(mesh.positions()(n, axis) - value) <= reach) nodes.push_back(n);
  }
  return nodes;
}

/// Whether each node lies on the surface.
inline std::vector<bool> is_on_boundary(const HexMesh& mesh) {
  std::vector<bool> on_boundary(mesh.num_nodes(), false);
  for (const std::array<int, 4>& face : mesh.boundary_faces()) {
    for (const int n : face) on_boundary[n] = true;
  }
  return on_boundary;
}

}  // namespace hexaplast::support
