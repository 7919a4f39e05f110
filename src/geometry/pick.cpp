// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/pick.hpp"

#include <algorithm>

#include "base/require.hpp"

namespace hexaplast {
namespace {

/// Distance along a unit direction to a triangle: o + t d = a + r (b - a) + s (c - a), solved by Cramer's rule.
std::optional<double> distance_to(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b,
                                  const Vec3& c) {
  const Vec3 u = b - a, v = c - a, from_a = origin - a;
  const Vec3 normal = u.cross(v);  // twice the area long
  const double slope = -direction.dot(normal);
  if (slope == 0) return {};
  const Vec3 turned = from_a.cross(direction);
  const double r = v.dot(turned) / slope, s = -u.dot(turned) / slope, t = from_a.dot(normal) / slope;
  if (!(r >= 0 && s >= 0 && r + s <= 1 && t >= 0)) return {};
  return t;
}

/// Calls visit(face, a, b, c) for every triangle that faces count as.
template <class Visit>
void for_each_triangle(std::span<const Triangle> triangles, const Visit& visit) {
  for (std::size_t f = 0; f < triangles.size(); ++f) visit(f, triangles[f][0], triangles[f][1], triangles[f][2]);
}

template <class Visit>
void for_each_triangle(std::span<const Quad> quads, const Visit& visit) {
  for (std::size_t f = 0; f < quads.size(); ++f) {
    const auto& [a, b, c, d] = quads[f];
    visit(f, a, b, c);
    visit(f, a, c, d);
  }
}

template <class Face>
std::optional<Hit> nearest_hit(const Ray& ray, ConstPoints x, std::span<const Face> faces) {
  const Vec3 direction = ray.direction.normalized();
  std::optional<Hit> first;
  for (const Face& face : faces) require_nodes("first_hit", face, x.rows());
  for_each_triangle(faces, [&](std::size_t face, int a, int b, int c) {
    const std::optional<double> distance =
        distance_to(ray.origin, direction, x.row(a).transpose(), x.row(b).transpose(), x.row(c).transpose());
    if (distance && (!first || *distance < first->distance))
      first = {static_cast<int>(face), *distance, ray.origin + *distance * direction};
  });
  return first;
}

}  // namespace

std::optional<Hit> first_hit(const Ray& ray, ConstPoints x, std::span<const Triangle> triangles) {
  return nearest_hit(ray, x, triangles);
}

std::optional<Hit> first_hit(const Ray& ray, ConstPoints x, std::span<const Quad> quads) {
  return nearest_hit(ray, x, quads);
}

std::vector<int> nearest_nodes(ConstPoints x, std::span<const int> candidates, const Vec3& place, double radius,
                               int min_count) {
  require_nodes("nearest_nodes", candidates, x.rows());
  const auto squared_distance = [&](int node) { return (x.row(node).transpose() - place).squaredNorm(); };
  std::vector<int> nodes(candidates.begin(), candidates.end());
  std::ranges::stable_sort(nodes, {}, squared_distance);
  const auto beyond = std::ranges::find_if(nodes, [&](int n) { return squared_distance(n) > radius * radius; });
  const auto count =
      std::max<std::ptrdiff_t>(beyond - nodes.begin(), std::min<std::ptrdiff_t>(min_count, std::ssize(nodes)));
  nodes.resize(static_cast<std::size_t>(count));
  std::ranges::sort(nodes);
  return nodes;
}

}  // namespace hexaplast
