// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
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

}  // namespace hexaplast::support
