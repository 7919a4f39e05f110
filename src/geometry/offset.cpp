// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/offset.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "mesh/offenders.hpp"
#include "mesh/trilinear.hpp"

namespace hexaplast {
namespace {

// Eigenvalue of sum a n n^T, relative to the largest, from which on a direction counts as one in which the surface
// bends sharply: an edge of 25 degrees between two faces.
constexpr double kSharp = 0.05;

// Smallest cosine between the way of a vertex and the normals around it: at an edge of less than 12 degrees the mitre
// is ten times as long as the surface moves.
constexpr double kMinCosine = 0.1;

constexpr std::size_t kWorstQuads = 5;

/// A corner of a quad, seen from its vertex.
struct Corner {
  Vec3 normal;    // unit
  double angle;   // [rad]
  double weight;  // [1/m^2] sine of the angle over the product of the edges' lengths
};

Corner corner_of(const QuadSurface& surface, const QuadSurface::Incidence& incidence) {
  const auto [q, k] = incidence;
  const Vec3 forward = surface.at(q, k + 1) - surface.at(q, k), back = surface.at(q, k - 1) - surface.at(q, k);
  const Vec3 across = forward.cross(back);
  return {across.normalized(), std::atan2(across.norm(), forward.dot(back)),
          across.norm() / (forward.squaredNorm() * back.squaredNorm())};
}

/// Zero where there is no direction away from all corners.
Vec3 direction_at(const std::vector<Corner>& corners) {
  Vec3 mean = Vec3::Zero();
  for (const Corner& corner : corners) mean += corner.weight * corner.normal;
  mean.normalize();
  double sum = 0, cosine = 0;  // the latter becomes the mean of those between m and the normals
  for (const Corner& corner : corners) {
    sum += corner.angle;
    cosine += corner.angle * corner.normal.dot(mean);
  }
  cosine /= sum;
  if (!(cosine > kMinCosine)) return Vec3::Zero();
  Vec3 u = mean / cosine;

  // least squares in the directions in which the normals differ much
  Mat3 A = Mat3::Zero();
  Vec3 residual = Vec3::Zero();
  for (const auto& [normal, angle, weight] : corners) {
    A += angle * normal * normal.transpose();
    residual += angle * (1 - normal.dot(u)) * normal;
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(A);
  for (int i = 0; i < 3; ++i) {
    const double stiffness = eigen.eigenvalues()[i];
    const Vec3 axis = eigen.eigenvectors().col(i);
    if (stiffness >= kSharp * eigen.eigenvalues()[2]) u += axis.dot(residual) / stiffness * axis;
  }

  for (const Corner& corner : corners)
    if (!(corner.normal.dot(u) > kMinCosine * u.norm())) return Vec3::Zero();
  return u;
}

/// The interval around 0 in which a + b t + c t^2 stays positive, a > 0.
struct Interval {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();

  bool contains(double t) const { return t > min && t < max; }
  void end_at(double t) {
    if (t > 0) max = std::min(max, t);
    if (t < 0) min = std::max(min, t);
  }
  void stay_positive(double a, double b, double c) {
    const double discriminant = b * b - 4 * a * c;
    if (discriminant < 0) return;
    // the form of the roots that loses no digits, and holds where c or b is 0
    const double half = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    if (half != 0) end_at(a / half);
    if (c != 0) end_at(half / c);
  }
};

/// How far a quad moves until a corner turns over, or an edge points the other way: of the two principal stretches of
/// the moved quad, either one changes sign then, or both.
Interval range_of(const QuadSurface& surface, const PointArray& directions, int q) {
  const auto way = [&](int k) -> Vec3 { return directions.row(surface.quads()[q][(k + 4) % 4]).transpose(); };
  Interval range;
  for (int k = 0; k < 4; ++k) {
    const Vec3 e = surface.at(q, k + 1) - surface.at(q, k), de = way(k + 1) - way(k);
    const Vec3 g = surface.at(q, k - 1) - surface.at(q, k), dg = way(k - 1) - way(k);
    const Vec3 normal = e.cross(g);
    range.stay_positive(e.squaredNorm(), e.dot(de), 0);
    range.stay_positive(normal.squaredNorm(), normal.dot(e.cross(dg) + de.cross(g)), normal.dot(de.cross(dg)));
  }
  return range;
}

std::string described(double limit) {
  return std::isfinite(limit) ? fmt::format("less than {:.4g}", limit) : "any distance";
}

/// Throws unless the numbers make sense for this surface.
void check(const QuadSurface& surface, const ShellThickness& thickness) {
  const auto& [inward, outward, layers] = thickness;
  if (!std::isfinite(inward) || !std::isfinite(outward) || inward + outward == 0)
    throw InputError(
        fmt::format("a thickness of {} inward and {} outward: must be finite, and their sum not 0", inward, outward));
  if (layers < 1) throw InputError(fmt::format("{} layers: at least 1 needed", layers));
  const std::int64_t max = std::numeric_limits<int>::max();
  if (surface.num_vertices() * (std::int64_t{layers} + 1) > max || surface.num_quads() * std::int64_t{layers} > max)
    throw InputError(fmt::format("{} layers over {} quads make more nodes than can be counted ({})", layers,
                                 surface.num_quads(), max));
}

PointArray positions_of(const QuadSurface& surface, const PointArray& directions, const ShellThickness& thickness) {
  const auto& [inward, outward, layers] = thickness;
  PointArray x(Eigen::Index{surface.num_vertices()} * (layers + 1), 3);
  for (int n = 0; n < surface.num_vertices(); ++n)
    for (int l = 0; l <= layers; ++l) {
      const double fraction = static_cast<double>(l) / layers;
      x.row(Eigen::Index{n} * (layers + 1) + l) =
          surface.positions().row(n) + (fraction * outward - (1 - fraction) * inward) * directions.row(n);
    }
  return x;
}

std::vector<Hexahedron> hexahedra_of(const QuadSurface& surface, const ShellThickness& thickness) {
  const int layers = thickness.layers;
  const bool is_reversed = thickness.inward + thickness.outward < 0;  // layers are counted against the normals
  std::vector<Hexahedron> hexahedra;
  hexahedra.reserve(static_cast<std::size_t>(surface.num_quads()) * layers);
  for (const Quad& quad : surface.quads())
    for (int l = 0; l < layers; ++l) {
      Hexahedron corners;
      for (int k = 0; k < 4; ++k) {
        corners[k] = quad[k] * (layers + 1) + l + (is_reversed ? 1 : 0);
        corners[k + 4] = quad[k] * (layers + 1) + l + (is_reversed ? 0 : 1);
      }
      hexahedra.push_back(corners);
    }
  return hexahedra;
}

}  // namespace

PointArray offset_directions(const QuadSurface& surface) {
  PointArray directions(surface.num_vertices(), 3);
  Offenders sharp;
  std::vector<Corner> corners;
  for (int n = 0; n < surface.num_vertices(); ++n) {
    corners.clear();
    for (const QuadSurface::Incidence& incidence : surface.incident(n))
      corners.push_back(corner_of(surface, incidence));
    const Vec3 u = direction_at(corners);
    if (u.isZero(0)) sharp.add(n);
    directions.row(n) = u.transpose();
  }
  sharp.refuse("vertices are too sharp to be offset",
               "one direction must lead away from all quads around a vertex, by more than 6 degrees");
  return directions;
}

OffsetLimits offset_limits(const QuadSurface& surface, const PointArray& directions) {
  OffsetLimits limits;
  for (int q = 0; q < surface.num_quads(); ++q) {
    const Interval range = range_of(surface, directions, q);
    limits = {std::min(limits.inward, -range.min), std::min(limits.outward, range.max)};
  }
  return limits;
}

Shell offset(const QuadSurface& surface, const ShellThickness& thickness) {
  check(surface, thickness);
  const PointArray directions = offset_directions(surface);
  PointArray x = positions_of(surface, directions, thickness);
  std::vector<Hexahedron> hexahedra = hexahedra_of(surface, thickness);

  std::vector<double> shape(surface.num_quads(), std::numeric_limits<double>::infinity());  // smallest over the layers
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    double& min = shape[e / thickness.layers];
    min = std::min(min, scaled_jacobian(gather(x, hexahedra[e])));
  }
  std::vector<int> order(shape.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return shape[a] < shape[b]; });

  Offenders folded;
  int worst = -1;
  for (int q = 0; q < surface.num_quads(); ++q) {
    const Interval range = range_of(surface, directions, q);
    if (range.contains(-thickness.inward) && range.contains(thickness.outward) && shape[q] > 0) continue;
    folded.add(q);
    if (worst < 0 || shape[q] < shape[worst]) worst = q;
  }
  if (folded.count() > 0) {
    const OffsetLimits limits = offset_limits(surface, directions);
    throw InputError(fmt::format(
        "{} quads fold when offset by {} inward and {} outward: {}; the worst is {}, with a scaled Jacobian of {:.3g}; "
        "the surface can go {} inward and {} outward",
        folded.count(), thickness.inward, thickness.outward, folded.list(), worst, shape[worst],
        described(limits.inward), described(limits.outward)));
  }

  order.resize(std::min(order.size(), kWorstQuads));
  Shell shell{HexMesh(std::move(x), std::move(hexahedra)), {}, std::move(order)};
  shell.quality = quality(shell.mesh);
  return shell;
}

}  // namespace hexaplast
