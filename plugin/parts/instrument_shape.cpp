// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/instrument_shape.hpp"

#include <cmath>
#include <numbers>

namespace hexaplast::parts {
namespace {

constexpr int kAround = 32;  // corners of a circle
constexpr int kQuarter = 8;  // edges from the equator of a ball to a pole
constexpr double kPi = std::numbers::pi;

/// A place of a profile: at this distance from the z axis, at this height.
struct Place {
  double radius, height;
};

/// What a profile from the lowest place of the axis to the highest one sweeps around z. Both ends are on the axis.
InstrumentShape revolved(const std::vector<Place>& profile) {
  const int num_rings = static_cast<int>(profile.size()) - 2;
  InstrumentShape shape;
  shape.points.resize(2 + num_rings * kAround, 3);
  const int bottom = 0, top = 1;
  const auto corner = [](int ring, int k) { return 2 + ring * kAround + k % kAround; };
  shape.points.row(bottom) << 0, 0, profile.front().height;
  shape.points.row(top) << 0, 0, profile.back().height;
  for (int ring = 0; ring < num_rings; ++ring)
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * kPi * k / kAround, radius = profile[ring + 1].radius;
      shape.points.row(corner(ring, k)) << radius * std::cos(angle), radius * std::sin(angle), profile[ring + 1].height;
    }
  for (int k = 0; k < kAround; ++k) {
    shape.triangles.push_back({bottom, corner(0, k + 1), corner(0, k)});
    for (int ring = 0; ring + 1 < num_rings; ++ring) {
      shape.triangles.push_back({corner(ring, k), corner(ring, k + 1), corner(ring + 1, k + 1)});
      shape.triangles.push_back({corner(ring, k), corner(ring + 1, k + 1), corner(ring + 1, k)});
    }
    shape.triangles.push_back({corner(num_rings - 1, k), corner(num_rings - 1, k + 1), top});
  }
  return shape;
}

/// Two half balls with a cylinder of this length between them.
InstrumentShape capsule(double radius, double length) {
  std::vector<Place> profile;
  for (const double side : {-1.0, 1.0})
    for (int k = 0; k <= kQuarter; ++k) {
      if (side > 0 && k == 0 && length == 0) continue;  // the equator is there
      const double angle = kPi / 2 * (side < 0 ? k - kQuarter : k) / kQuarter;
      profile.push_back({radius * std::cos(angle), side * length / 2 + radius * std::sin(angle)});
    }
  return revolved(profile);
}

InstrumentShape cylinder(double radius, double length) {
  return revolved({{0, -length / 2}, {radius, -length / 2}, {radius, length / 2}, {0, length / 2}});
}

InstrumentShape box(const Vec3& size) {
  InstrumentShape shape;
  shape.points.resize(8, 3);
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) shape.points(corner, axis) = ((corner >> axis & 1) - 0.5) * size[axis];
  for (const auto& [a, b, c, d] :
       std::vector<Quad>{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a, c, d});
  }
  return shape;
}

}  // namespace

InstrumentShape shape_of(const InstrumentOptions& options) {
  using enum InstrumentOptions::Shape;
  switch (options.shape) {
    case kCapsule:
      return capsule(*options.radius, *options.length);
    case kCylinder:
      return cylinder(*options.radius, *options.length);
    case kBox:
      return box(*options.size);
    case kSurface:
      return {options.surface_positions, options.surface_triangles};
    case kSphere:
      break;
  }
  return capsule(*options.radius, 0);
}

InstrumentShape edge_of(const BladeOptions& options) {
  constexpr double kThickness = 0.01;  // of its length
  double length = 0;
  for (Eigen::Index k = 1; k < options.points.rows(); ++k)
    length += (options.points.row(k) - options.points.row(k - 1)).norm();
  InstrumentShape thread;
  for (Eigen::Index k = 1; k < options.points.rows(); ++k) {
    const Vec3 from = options.points.row(k - 1).transpose(), to = options.points.row(k).transpose();
    InstrumentShape piece = capsule(kThickness * length, (to - from).norm());
    piece.points = piece.at({(from + to) / 2, Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), to - from)});
    const auto first = static_cast<int>(thread.points.rows());
    thread.points.conservativeResize(first + piece.points.rows(), 3);
    thread.points.bottomRows(piece.points.rows()) = piece.points;
    for (const auto& [a, b, c] : piece.triangles) thread.triangles.push_back({first + a, first + b, first + c});
  }
  return thread;
}

PointArray InstrumentShape::at(const Pose& pose) const {
  return (points * pose.orientation.toRotationMatrix().transpose()).rowwise() + pose.position.transpose();
}

}  // namespace hexaplast::parts
