// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/geometry/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/lattice.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

using std::numbers::pi;

constexpr int kPiecesPerSpan = 64;  // in which the length of a curve is measured between two given points

void require_size(const char* name, double size) {
  if (!(size > 0 && std::isfinite(size)))
    throw InputError(fmt::format("{} of {} m: must be a finite number greater than 0", name, size));
}

void require_radii(double inner, double outer) {
  require_size("an inner radius", inner);
  require_size("an outer radius", outer);
  if (!(inner < outer))
    throw InputError(
        fmt::format("an inner radius of {} m and an outer one of {} m: must be the lesser one", inner, outer));
}

/// Nodes at place(i, j, k).
template <class Place>
HexMesh mapped(const NodeLattice& lattice, const Place& place) {
  PointArray positions(lattice.num_nodes(), 3);
  for (int k = 0; k < lattice.num_nodes(2); ++k)
    for (int j = 0; j < lattice.num_nodes(1); ++j)
      for (int i = 0; i < lattice.num_nodes(0); ++i) positions.row(lattice.node(i, j, k)) = place(i, j, k).transpose();
  return HexMesh(std::move(positions), lattice.hexahedra());
}

/// Where node i of n + 1 lies between two ends.
double between(double first, double last, int i, int n) { return first + (last - first) * i / n; }

double sine_over(double angle) { return angle == 0 ? 1 : std::sin(angle) / angle; }

/// A vector normal to each tangent, turning as little as can be from point to point: reflected in the plane halfway
/// between two points, and again so that tangent meets tangent (W. Wang et al., Computation of rotation minimizing
/// frames, 2008).
PointArray rotation_minimizing_normals(const Centreline& curve) {
  const Vec3 begin = curve.tangents.row(0).transpose();
  Vec3 normal = std::abs(begin.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  normal = (normal - normal.dot(begin) * begin).normalized();

  const auto reflected = [](const Vec3& v, const Vec3& across) -> Vec3 {
    const double squared = across.squaredNorm();
    return squared > 0 ? Vec3(v - 2 * across.dot(v) / squared * across) : v;
  };
  PointArray normals(curve.points.rows(), 3);
  normals.row(0) = normal.transpose();
  for (Eigen::Index k = 1; k < curve.points.rows(); ++k) {
    const Vec3 step = (curve.points.row(k) - curve.points.row(k - 1)).transpose();
    const Vec3 tangent = reflected(curve.tangents.row(k - 1).transpose(), step);
    normal = reflected(reflected(normal, step), curve.tangents.row(k).transpose() - tangent);
    normals.row(k) = normal.transpose();
  }
  return normals;
}

}  // namespace

HexMesh sheet(std::array<int, 3> cells, std::array<double, 2> size, double thickness, double curvature) {
  const NodeLattice lattice{cells};
  lattice.check();
  require_size("a side", size[0]);
  require_size("a side", size[1]);
  require_size("a thickness", thickness);
  if (!(std::abs(curvature) * thickness < 2))
    throw InputError(fmt::format("a curvature of {} 1/m folds a sheet {} m thick: must be below {:.6g}", curvature,
                                 thickness, 2 / thickness));
  if (!(std::abs(curvature) * size[0] < 2 * pi))
    throw InputError(fmt::format("a curvature of {} 1/m makes a sheet {} m long meet itself: must be below {:.6g}",
                                 curvature, size[0], 2 * pi / size[0]));

  return mapped(lattice, [&](int i, int j, int k) {
    const double x = between(-size[0] / 2, size[0] / 2, i, cells[0]);
    const double y = between(-size[1] / 2, size[1] / 2, j, cells[1]);
    const double z = between(-thickness / 2, thickness / 2, k, cells[2]);
    // (R + z) sin(x / R) and (R + z) cos(x / R) - R, in a form that holds for a plane as well
    const double angle = curvature * x, stretch = 1 + curvature * z;
    return Vec3(stretch * x * sine_over(angle), y, z - stretch * x * std::sin(angle / 2) * sine_over(angle / 2));
  });
}

HexMesh sphere_patch(std::array<int, 3> cells, double inner, double outer, double angle) {
  const NodeLattice lattice{cells};
  lattice.check();
  require_radii(inner, outer);
  if (!(angle > 0 && angle < pi))
    throw InputError(fmt::format("a patch of a sphere of {} rad from side to side: must lie in (0, pi)", angle));
  return mapped(lattice, [&](int i, int j, int k) {
    const Vec3 way(std::tan(between(-angle / 2, angle / 2, i, cells[0])),
                   std::tan(between(-angle / 2, angle / 2, j, cells[1])), 1);
    return Vec3(between(inner, outer, k, cells[2]) * way.normalized());
  });
}

Centreline arc(double length, double angle, int num_points) {
  require_size("a length", length);
  if (!(std::abs(angle) < 2 * pi))
    throw InputError(fmt::format("an arc of {} rad: must lie between -2 pi and 2 pi", angle));
  if (num_points < 2) throw InputError(fmt::format("a curve of {} points: at least 2 needed", num_points));
  Centreline curve{PointArray(num_points, 3), PointArray(num_points, 3)};
  for (int k = 0; k < num_points; ++k) {
    const double s = between(0, length, k, num_points - 1), turned = between(0, angle, k, num_points - 1);
    curve.points.row(k) << s * std::sin(turned / 2) * sine_over(turned / 2), 0, s * sine_over(turned);
    curve.tangents.row(k) << std::sin(turned), 0, std::cos(turned);
  }
  return curve;
}

Centreline curve_through(ConstPoints points, int num_points) {
  const int last = static_cast<int>(points.rows()) - 1;
  if (last < 1 || num_points < 2)
    throw InputError(fmt::format("a curve of {} points through {}: at least 2 needed", num_points, points.rows()));
  if (!points.allFinite()) throw InputError("a curve through points with a coordinate that is not finite");

  // slopes over the chord lengths: of the parabola through a point and its neighbours, at the ends its end slopes
  std::vector<double> chord(last);
  for (int i = 0; i < last; ++i) {
    chord[i] = (points.row(i + 1) - points.row(i)).norm();
    if (chord[i] == 0) throw InputError(fmt::format("points {} and {} of a curve lie at the same place", i, i + 1));
  }
  const auto secant = [&](int i) -> Vec3 { return (points.row(i + 1) - points.row(i)).transpose() / chord[i]; };
  std::vector<Vec3> slope(last + 1);
  for (int i = 1; i < last; ++i)
    slope[i] = (chord[i] * secant(i - 1) + chord[i - 1] * secant(i)) / (chord[i - 1] + chord[i]);
  slope[0] = last > 1 ? Vec3(2 * secant(0) - slope[1]) : secant(0);
  slope[last] = last > 1 ? Vec3(2 * secant(last - 1) - slope[last - 1]) : secant(0);

  // the cubic of span i at t in [0, 1], and its derivative
  const auto point = [&](int i, double t) -> Vec3 {
    const double u = 1 - t;
    return (u * u * (1 + 2 * t) * points.row(i) + t * t * (1 + 2 * u) * points.row(i + 1)).transpose() +
           chord[i] * t * u * (u * slope[i] - t * slope[i + 1]);
  };
  const auto derivative = [&](int i, double t) -> Vec3 {
    const double u = 1 - t;
    return chord[i] * (6 * t * u * secant(i) + u * (u - 2 * t) * slope[i] + t * (t - 2 * u) * slope[i + 1]);
  };

  std::vector<double> length{0};  // up to each end of a piece
  for (int i = 0; i < last; ++i)
    for (int piece = 0; piece < kPiecesPerSpan; ++piece)
      length.push_back(
          length.back() +
          (point(i, (piece + 1.0) / kPiecesPerSpan) - point(i, static_cast<double>(piece) / kPiecesPerSpan)).norm());
  Centreline curve{PointArray(num_points, 3), PointArray(num_points, 3)};
  for (int k = 0; k < num_points; ++k) {
    const double wanted = between(0, length.back(), k, num_points - 1);
    const auto above = std::upper_bound(length.begin() + 1, length.end() - 1, wanted);
    const auto piece = static_cast<int>(above - length.begin()) - 1;
    const double fraction = (wanted - length[piece]) / (length[piece + 1] - length[piece]);
    const int span = piece / kPiecesPerSpan;
    const double t = (piece % kPiecesPerSpan + fraction) / kPiecesPerSpan;
    curve.points.row(k) = point(span, t).transpose();
    curve.tangents.row(k) = derivative(span, t).normalized().transpose();
  }
  return curve;
}

HexMesh tube(std::array<int, 3> cells, double inner, double outer, const Centreline& along) {
  const NodeLattice lattice{cells, true};
  lattice.check();
  require_radii(inner, outer);
  if (along.points.rows() != cells[2] + 1 || along.tangents.rows() != along.points.rows())
    throw InputError(
        fmt::format("a tube of {} cells along a curve of {} points: must be one more", cells[2], along.points.rows()));
  const PointArray normals = rotation_minimizing_normals(along);
  const auto node = [&](int i, int j, int k) -> Vec3 {
    const double angle = 2 * pi * j / cells[1], radius = between(inner, outer, i, cells[0]);
    const Vec3 normal = normals.row(k).transpose();
    const Vec3 binormal = Vec3(along.tangents.row(k).transpose()).cross(normal);
    return along.points.row(k).transpose() + radius * (std::cos(angle) * normal + std::sin(angle) * binormal);
  };

  // on the inner side of a bend the sections come together; beyond its centre they would pass through each other
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j) {
      const Vec3 step = node(cells[0], j, k + 1) - node(cells[0], j, k);
      if (along.tangents.row(k).dot(step) > 0 && along.tangents.row(k + 1).dot(step) > 0) continue;
      throw InputError(
          fmt::format("a tube of outer radius {} m folds between sections {} and {}: the radius must be less than "
                      "that of the curve's bend",
                      outer, k, k + 1));
    }
  return mapped(lattice, node);
}

}  // namespace hexaplast
