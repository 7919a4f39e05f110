// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "hexaplast/base/types.hpp"

namespace hexaplast::support {

/// Random numbers that are the same on every machine: the engine and the way to a double are both fixed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double min, double max) {
    const double unit = static_cast<double>(engine_() >> 11) * 0x1p-53;  // [0, 1), every bit of a double's mantissa
    return min + (max - min) * unit;
  }

  Vec3 vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }

  /// Entries in [-size, size].
  Mat3 matrix(double size) {
    Mat3 A;
    for (int i = 0; i < 3; ++i) A.row(i) = vector(size).transpose();
    return A;
  }

  /// Entries in [-1, 1], row by row.
  Eigen::MatrixXd matrix(int rows, int columns) {
    return Eigen::MatrixXd::NullaryExpr(columns, rows, [this] { return uniform(-1, 1); }).eval().transpose();
  }

  /// Unit vector, from the ball so that no direction is preferred.
  Vec3 direction() {
    Vec3 v;
    do v = vector(1);
    while (v.squaredNorm() > 1 || v.squaredNorm() < 1e-4);
    return v.normalized();
  }

  Mat3 rotation() { return rotation_by(uniform(0, std::numbers::pi)); }

  /// Rotation by an angle [rad] about a random axis.
  Mat3 rotation_by(double angle) { return Eigen::AngleAxisd(angle, direction()).toRotationMatrix(); }

  /// Nodal field with entries in [-size, size].
  PointArray field(int num_nodes, double size) {
    PointArray values(num_nodes, 3);
    for (int n = 0; n < num_nodes; ++n) values.row(n) = vector(size).transpose();
    return values;
  }

 private:
  std::mt19937_64 engine_;
};

/// Deformation gradients of eight kinds: any, small strains, singular ones, inside out, with equal and nearly equal
/// stretches, of all sizes.
inline Mat3 gradient_of_kind(int kind, Random& random) {
  const Mat3 any = random.field(3, 1), turn = random.rotation(), other = random.rotation();
  const Vec3 d = random.vector(1);
  switch (kind) {
    case 0:
      return any;
    case 1:
      return turn * (Mat3::Identity() + 0.1 * any);
    case 2:
      return turn * Vec3(d[0], d[1], 0).asDiagonal() * other;
    case 3:
      return turn * Vec3(d[0], 0, 0).asDiagonal() * other;
    case 4:
      return turn * Vec3(1, 1, -std::abs(d[0])).asDiagonal() * other;
    case 5:
      return turn * Vec3(1, 1 + 1e-9 * d[1], 1 - 1e-12 * d[2]).asDiagonal() * other;
    case 6:
      return any * std::pow(10.0, 150 * d[0]);
    default:
      return Mat3::Zero();
  }
}

}  // namespace hexaplast::support
