// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/contact/surface_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/memory.hpp"
#include "base/require.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/geometry/embed.hpp"

namespace hexaplast {
namespace {

/// A face between its corners, (u, v) in [0, 1]^2, corner 0 at (0, 0) and corner 2 at (1, 1).
struct Patch {
  std::array<Vec3, 4> corners;

  /// [m^2] of the part [u, u + du] x [v, v + dv], by its middle.
  double area(double u, double v, double du, double dv) const {
    const double mid_u = u + du / 2, mid_v = v + dv / 2;
    const Vec3 along_u = (1 - mid_v) * (corners[1] - corners[0]) + mid_v * (corners[2] - corners[3]),
               along_v = (1 - mid_u) * (corners[3] - corners[0]) + mid_u * (corners[2] - corners[1]);
    return along_u.cross(along_v).norm() * du * dv;
  }
};

void check(double wanted, int max_parts) {
  if (!(wanted > 0)) throw InputError(fmt::format("SurfaceSamples: spacing {} must be positive", wanted));
  if (max_parts < 1) throw InputError(fmt::format("SurfaceSamples: {} parts of an edge must be at least 1", max_parts));
}

constexpr double kRoundingOfParts = 1e-9;  // of a part: an edge of exactly two parts is not three

int parts_of(double longest_edge, double wanted, int max_parts) {
  return std::clamp(static_cast<int>(std::min(std::ceil(longest_edge / wanted - kRoundingOfParts), 1e9)), 1, max_parts);
}

/// [byte] of a sample, what contact keeps for it, and what finding it takes.
constexpr double kBytesPerSample = 450;

/// What samples are made by: into how many parts edges are divided, the same on every face, so that neighbours have
/// their points in common.
struct Plan {
  int parts;
  SurfaceSamples samples;  // none yet
};

/// per_parts: samples of each face or triangle, for the square of the parts.
Plan planned(double longest_edge, double wanted, int max_parts, std::size_t num_faces, double per_parts) {
  const int parts = parts_of(longest_edge, wanted, max_parts);
  return {parts,
          {.samples = {},
           .spacing = longest_edge / parts,
           .memory = grant_memory(fmt::format("contact at points of {} faces, edges in {} parts,", num_faces, parts),
                                  static_cast<double>(num_faces) * per_parts * parts * parts * kBytesPerSample)}};
}

Plan plan_on(const HexMesh& mesh, std::size_t num_faces, double wanted, int max_parts) {
  check(wanted, max_parts);
  // also of edges inside, so that samples stay the same when hexahedra go
  double longest = 0;
  for (const Hexahedron& nodes : mesh.hexahedra())
    for (const auto& [a, b] : kEdges)
      longest = std::max(longest, (mesh.positions().row(nodes[a]) - mesh.positions().row(nodes[b])).norm());
  return planned(longest, wanted, max_parts, num_faces, 1);
}

Plan plan_on_embedded(ConstPoints surface, const std::vector<Triangle>& triangles, double wanted, int max_parts) {
  check(wanted, max_parts);
  double longest = 0;
  for (const Triangle& triangle : triangles) {
    require_nodes("SurfaceSamples", triangle, surface.rows());
    for (int a = 0; a < 3; ++a)
      longest = std::max(longest, (surface.row(triangle[a]) - surface.row(triangle[(a + 1) % 3])).norm());
  }
  return planned(longest, wanted, max_parts, triangles.size(), 0.5);
}

/// A point of a face by its nodes and the fractions that it has of them, in parts of the edges, ascending: the same
/// whichever of the faces names it. Fractions of 0 do not count.
template <std::size_t N>
using FaceWeights = std::array<std::pair<int, int>, N>;

template <std::size_t N>
FaceWeights<N> key_of(const std::array<int, N>& nodes, const std::array<int, N>& weights) {
  FaceWeights<N> key;
  for (std::size_t a = 0; a < N; ++a) key[a] = weights[a] > 0 ? std::pair(nodes[a], weights[a]) : std::pair(-1, 0);
  std::ranges::sort(key);
  return key;
}

/// around: pairs of a sample and a face.
void set_faces_around(SurfaceSamples& found, const std::vector<std::pair<int, int>>& around) {
  found.first_face.assign(found.samples.size() + 1, 0);
  for (const auto& [sample, face] : around) ++found.first_face[static_cast<std::size_t>(sample) + 1];
  for (std::size_t i = 1; i < found.first_face.size(); ++i) found.first_face[i] += found.first_face[i - 1];
  found.faces_around.resize(around.size());
  std::vector<int> next(found.first_face.begin(), found.first_face.end() - 1);
  for (const auto& [sample, face] : around) found.faces_around[static_cast<std::size_t>(next[sample]++)] = face;
}

}  // namespace

Vec3 SurfaceSamples::outwards(int sample, ConstPoints x) const {
  Vec3 sum = Vec3::Zero();
  for (int k = first_face[sample]; k < first_face[sample + 1]; ++k) {
    const auto corner = [&](int a) { return samples[faces[faces_around[k]][a]].at(x); };
    sum += (corner(2) - corner(0)).cross(corner(3) - corner(1));
  }
  return sum.normalized();
}

SurfaceSamples SurfaceSamples::on(const HexMesh& mesh, std::span<const unsigned char> alive, double wanted,
                                  int max_parts) {
  const std::vector<Quad> faces = mesh.boundary_faces(alive);
  std::vector<Patch> patches;
  for (const Quad& face : faces) {
    Patch& patch = patches.emplace_back();
    for (int a = 0; a < 4; ++a) patch.corners[a] = mesh.positions().row(face[a]).transpose();
  }
  Plan plan = plan_on(mesh, faces.size(), wanted, max_parts);
  const int parts = plan.parts;
  SurfaceSamples found = std::move(plan.samples);
  found.samples.reserve(faces.size() * static_cast<std::size_t>(parts) * static_cast<std::size_t>(parts) + 2);
  std::map<FaceWeights<4>, std::size_t> known;  // on the edges of faces
  std::vector<std::pair<int, int>> around;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::array<int, 4>& corners = found.faces.emplace_back();
    for (int j = 0; j <= parts; ++j)
      for (int i = 0; i <= parts; ++i) {
        const double step = 1.0 / parts;
        double area = 0;  // a quarter of each of the parts around the point
        for (int dj = -1; dj <= 0; ++dj)
          for (int di = -1; di <= 0; ++di)
            if (i + di >= 0 && i + di < parts && j + dj >= 0 && j + dj < parts)
              area += patches[f].area((i + di) * step, (j + dj) * step, step, step) / 4;

        const std::array<int, 4> weights = {(parts - i) * (parts - j), i * (parts - j), i * j, (parts - i) * j};
        std::size_t at = found.samples.size();
        if (i == 0 || i == parts || j == 0 || j == parts)
          at = known.emplace(key_of(faces[f], weights), at).first->second;
        if (at == found.samples.size()) {
          SurfaceSamples::Sample& sample = found.samples.emplace_back();
          for (int a = 0; a < 4; ++a) {
            if (weights[a] == 0) continue;
            sample.nodes[sample.num_nodes] = faces[f][a];
            sample.weights[sample.num_nodes++] = weights[a] / (1.0 * parts * parts);
          }
        }
        found.samples[at].area += area;
        around.emplace_back(static_cast<int>(at), static_cast<int>(f));
        for (int a = 0; a < 4; ++a)
          if (weights[a] == parts * parts) corners[a] = static_cast<int>(at);
      }
  }
  set_faces_around(found, around);
  return found;
}

SurfaceSamples SurfaceSamples::on_embedded(const HexMesh& mesh, std::span<const unsigned char> alive,
                                           ConstPoints surface, const std::vector<Triangle>& triangles, double wanted,
                                           int max_parts) {
  Plan plan = plan_on_embedded(surface, triangles, wanted, max_parts);
  const int parts = plan.parts;
  SurfaceSamples found = std::move(plan.samples);
  std::map<FaceWeights<3>, std::size_t> known;
  std::vector<Vec3> points;
  std::vector<std::pair<std::size_t, double>> of_triangle;  // its points and their areas, triangle by triangle
  for (const Triangle& triangle : triangles) {
    const auto corner = [&](int a) { return Vec3(surface.row(triangle[a]).transpose()); };
    const double area = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    for (int j = 0; j <= parts; ++j)
      for (int i = 0; i + j <= parts; ++i) {
        const std::array<int, 3> weights = {parts - i - j, i, j};
        const auto [at, is_new] = known.emplace(key_of(triangle, weights), points.size());
        if (is_new) {
          points.push_back((weights[0] * corner(0) + weights[1] * corner(1) + weights[2] * corner(2)) / parts);
        }
        // thirds of the small triangles around it: one at a corner, three on an edge, six inside
        const auto num_corners = std::ranges::count(weights, 0);
        const int around = num_corners == 2 ? 1 : num_corners == 1 ? 3 : 6;
        of_triangle.emplace_back(at->second, area * around / (3.0 * parts * parts));
      }
  }

  PointArray places(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) places.row(static_cast<Eigen::Index>(k)) = points[k].transpose();
  const Embedding embedding(mesh.positions(), mesh.hexahedra(), places);
  // of the triangles that are there, as long as one is
  std::vector<double> areas(points.size(), 0);
  std::vector<unsigned char> is_left(points.size(), 0);
  std::vector<std::pair<int, int>> around;  // by points
  const std::size_t per_triangle = triangles.empty() ? 1 : of_triangle.size() / triangles.size();
  for (std::size_t first = 0; first < of_triangle.size(); first += per_triangle) {
    const std::span own(of_triangle.data() + first, per_triangle);
    const bool is_there = alive.empty() || std::ranges::all_of(own, [&](const auto& point) {
                            return alive[embedding.hexahedron_of(static_cast<int>(point.first))] != 0;
                          });
    if (!is_there) continue;
    for (const auto& point : own) {
      is_left[point.first] = 1;
      areas[point.first] += point.second;
      around.emplace_back(static_cast<int>(point.first), static_cast<int>(found.faces.size()));
    }
    const auto point_at = [&](int k) { return static_cast<int>(own[static_cast<std::size_t>(k)].first); };
    const int first_corner = point_at(0);
    found.faces.push_back({first_corner, point_at(parts), point_at(static_cast<int>(per_triangle) - 1), first_corner});
  }
  std::vector<int> sample_of(points.size(), -1);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!is_left[k]) continue;
    const int point = static_cast<int>(k);
    sample_of[k] = static_cast<int>(found.samples.size());
    found.samples.push_back({.nodes = mesh.hexahedra()[embedding.hexahedron_of(point)],
                             .weights = embedding.weights_of(point),
                             .num_nodes = kCorners,
                             .area = areas[k]});
  }
  for (auto& face : found.faces)
    for (int& corner : face) corner = sample_of[corner];
  for (auto& [point, face] : around) point = sample_of[point];
  set_faces_around(found, around);
  return found;
}

SurfaceSamples SurfaceSamples::planned_on(const HexMesh& mesh, std::span<const unsigned char> alive, double wanted,
                                          int max_parts) {
  return plan_on(mesh, mesh.boundary_faces(alive).size(), wanted, max_parts).samples;
}

SurfaceSamples SurfaceSamples::planned_on_embedded(ConstPoints surface, const std::vector<Triangle>& triangles,
                                                   double wanted, int max_parts) {
  return plan_on_embedded(surface, triangles, wanted, max_parts).samples;
}

}  // namespace hexaplast
