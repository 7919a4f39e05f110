// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "base/disjoint_sets.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/voxels.hpp"
#include "mesh/neighbours.hpp"

namespace hexaplast {
namespace {

constexpr int kSmoothings = 20;
constexpr double kShrink = 0.5, kGrow = -0.53;  // by turns: waves of a few cells vanish, longer ones stay

/// The faces on the border of a label, seen from outside it.
std::vector<BoundaryFace> border_of(const VoxelMesh& voxels, int label) {
  std::vector<unsigned char> has_label;
  for (const int each : voxels.labels) has_label.push_back(each == label);
  std::vector<BoundaryFace> border = boundary_of(voxels.mesh, has_label);
  std::ranges::sort(border, {}, [](const BoundaryFace& face) { return std::pair(face.element, face.nodes); });
  return border;
}

/// A side of a face: from corner `corner` to the next one.
struct Side {
  Edge nodes;  // lesser first
  int hexahedron, face, corner;
};

/// Joins the corners of faces that meet at an edge: corner c of face f has the number 4 f + c. Where four faces meet
/// there, each two of one hexahedron do.
DisjointSets joined_corners(const std::vector<BoundaryFace>& faces) {
  std::vector<Side> sides;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int c = 0; c < 4; ++c)
      sides.push_back(
          {sorted(Edge{faces[f].nodes[c], faces[f].nodes[(c + 1) % 4]}), faces[f].element, static_cast<int>(f), c});
  std::ranges::sort(sides, {}, [](const Side& s) { return std::tuple(s.nodes, s.hexahedron, s.face, s.corner); });

  DisjointSets corners(static_cast<int>(4 * faces.size()));
  for (std::size_t s = 0; s + 1 < sides.size(); s += 2) {
    const Side &a = sides[s], &b = sides[s + 1];
    for (const int i : {0, 1})
      for (const int j : {0, 1}) {
        const int of_a = (a.corner + i) % 4, of_b = (b.corner + j) % 4;
        if (faces[static_cast<std::size_t>(a.face)].nodes[of_a] == faces[static_cast<std::size_t>(b.face)].nodes[of_b])
          corners.join(4 * a.face + of_a, 4 * b.face + of_b);
      }
  }
  return corners;
}

/// Moves every vertex towards the mean of its neighbours, or away from it, but not out of its own half cell.
void smooth(const PointArray& original, const Mat3& cell, double factor, VoxelSurface& surface) {
  PointArray sum = PointArray::Zero(original.rows(), 3);
  std::vector<int> count(static_cast<std::size_t>(original.rows()), 0);
  for (const Quad& quad : surface.quads)
    for (int c = 0; c < 4; ++c)
      for (const int step : {1, 3}) {
        sum.row(quad[c]) += surface.positions.row(quad[(c + step) % 4]);
        ++count[static_cast<std::size_t>(quad[c])];
      }
  const Mat3 to_cells = cell.inverse();
  for (Eigen::Index n = 0; n < original.rows(); ++n) {
    const Vec3 x = surface.positions.row(n).transpose(), first = original.row(n).transpose();
    const Vec3 mean = sum.row(n).transpose() / count[static_cast<std::size_t>(n)];
    const Vec3 moved = to_cells * (x + factor * (mean - x) - first);  // in cells
    surface.positions.row(n) = (first + cell * moved.cwiseMax(-0.5).cwiseMin(0.5)).transpose();
  }
}

}  // namespace

VoxelSurface surface_of_label(const VoxelMesh& voxels, int label, const Mat3& cell) {
  const std::vector<BoundaryFace> faces = border_of(voxels, label);
  if (faces.empty()) throw InputError(fmt::format("no hexahedron has the label {}", label));
  DisjointSets corners = joined_corners(faces);

  VoxelSurface surface;
  surface.positions.resize(corners.num_sets(), 3);
  std::vector<int> vertex(4 * faces.size(), -1);  // of a corner that stands for its set
  int next = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Quad& quad = surface.quads.emplace_back();
    for (int c = 0; c < 4; ++c) {
      int& number = vertex[static_cast<std::size_t>(corners.root(4 * static_cast<int>(f) + c))];
      if (number < 0) {
        number = next++;
        surface.positions.row(number) = voxels.mesh.positions().row(faces[f].nodes[c]);
      }
      quad[c] = number;
    }
  }
  const PointArray original = surface.positions;
  for (int i = 0; i < kSmoothings; ++i)
    for (const double factor : {kShrink, kGrow}) smooth(original, cell, factor, surface);
  return surface;
}

}  // namespace hexaplast
