// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/rest_shape.hpp"

#include <algorithm>

#include "kinematics/polar.hpp"
#include "plastic/rest_shape-inl.hpp"

namespace hexaplast {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

namespace {

constexpr double kRepairRate = 5;  // [1/s] a jammed shape is back within a few tenths of a second

}  // namespace

void deform_rest_shape(const std::array<Mat3, kCorners>& increments, const std::array<Mat3, kCorners>& rotation_maps,
                       ElementPoints& y) {
  for (int i = 0; i < kCorners; ++i) {
    const Mat3& Pi = rotation_maps[i];
    y.row(i) = (Pi.transpose() * (increments[i] * (Pi * y.row(i).transpose()))).transpose();
  }
  y = about_mean(y);
}

void repair_rest_shape(const ElementPoints& initial, double dt, ElementPoints& y) {
  const ElementPoints turned = initial * fit_rotation(initial, y).transpose();
  y += std::min(1.0, kRepairRate * dt) * (turned - y);
}

void restore_volume(double volume_ratio, double rate, double dt, ElementPoints& y) {
  y *= scalar::restitution_scale(volume_ratio, rate * dt);
}

Mat3 fit_rotation(const ElementPoints& from, const ElementPoints& to) { return polar(to.transpose() * from).R; }

}  // namespace hexaplast
