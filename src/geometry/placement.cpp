// SPDX-License-Identifier: LGPL-2.1-or-later
#include "geometry/placement.hpp"

#include <numbers>

namespace hexaplast {

void place(PointArray& points, const Vec3& scale, const Vec3& degrees, const Vec3& translation) {
  const Vec3 angle = degrees * std::numbers::pi / 180;
  const Mat3 turn = (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
                     Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
                        .toRotationMatrix();
  if (scale != Vec3::Ones()) points = points * scale.asDiagonal();
  if (!angle.isZero(0)) points = points * turn.transpose();
  if (!translation.isZero(0)) points.rowwise() += translation.transpose();
}

}  // namespace hexaplast
