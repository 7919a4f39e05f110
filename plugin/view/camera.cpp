// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hexaplast::view {
namespace {

constexpr double kHalfAngle = 14;                                          // [deg] from the middle to the upper border
const double kHalfHeight = std::tan(kHalfAngle * std::numbers::pi / 180);  // of the picture, at distance 1
constexpr double kTurn = 0.008;                                            // [rad/pixel]
constexpr double kSteepest = 1.55;                                         // [rad] just short of straight above
constexpr double kClick = 0.88;                                            // of the distance is left after a click
constexpr double kRoom = 1.12;                                             // around what is fitted

}  // namespace

Camera::Camera(const Vec3& up, const Vec3& towards) {
  const Vec3 axis = up.normalized();
  const Vec3 level = (towards - towards.dot(axis) * axis).normalized();
  table_ << level.transpose(), axis.cross(level).transpose(), axis.transpose();
  elevation_ = std::clamp(std::asin(towards.normalized().dot(axis)), -kSteepest, kSteepest);
}

void Camera::resize(int width, int height) {
  width_ = std::max(width, 1);
  height_ = std::max(height, 1);
}

void Camera::fit(const Eigen::AlignedBox3d& box, double strip) {
  target_ = box.center();
  const Mat3 turned = axes();
  const double aspect = width_ / height_, part = std::max(1 - strip / height_, 0.1);
  distance_ = 0;
  for (int k = 0; k < 8; ++k) {
    const Vec3 corner = turned * (box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)) - target_);
    const double across = std::max(std::abs(corner.x()) / aspect, std::abs(corner.y()) / part) / kHalfHeight;
    distance_ = std::max(distance_, corner.z() + kRoom * across);
  }
  distance_ = std::max(distance_, 1e-9);
  pan(0, -strip / 2);
}

void Camera::orbit(double right, double down) {
  azimuth_ -= kTurn * right;
  elevation_ = std::clamp(elevation_ + kTurn * down, -kSteepest, kSteepest);
}

void Camera::pan(double right, double down) {
  const Mat3 turned = axes();
  target_ += metres_per_pixel(target_) * (-right * turned.row(0) + down * turned.row(1)).transpose();
}

void Camera::zoom(double clicks) { distance_ *= std::pow(kClick, clicks); }

Mat3 Camera::axes() const {
  const double level = std::cos(elevation_);
  const Vec3 towards =
      table_.transpose() * Vec3(level * std::cos(azimuth_), level * std::sin(azimuth_), std::sin(elevation_));
  const Vec3 right = table_.transpose() * Vec3(-std::sin(azimuth_), std::cos(azimuth_), 0);
  Mat3 turned;
  turned << right.transpose(), towards.cross(right).transpose(), towards.transpose();
  return turned;
}

Vec3 Camera::eye() const { return target_ + distance_ * axes().row(2).transpose(); }

Ray Camera::ray(double x, double y) const {
  const double scale = 2 * kHalfHeight / height_;
  const Vec3 seen(scale * (x - width_ / 2), scale * (height_ / 2 - y), -1);
  return {eye(), axes().transpose() * seen};
}

Vec3 Camera::at_depth_of(const Vec3& place, double x, double y) const {
  const Ray through = ray(x, y);
  const Vec3 towards = axes().row(2).transpose();
  return through.origin + (place - through.origin).dot(towards) / through.direction.dot(towards) * through.direction;
}

Eigen::Vector2d Camera::pixel_of(const Vec3& place) const {
  const Vec3 seen = axes() * (place - eye());
  const double scale = height_ / (2 * kHalfHeight * -seen.z());
  return {width_ / 2 + scale * seen.x(), height_ / 2 - scale * seen.y()};
}

double Camera::metres_per_pixel(const Vec3& place) const {
  return 2 * kHalfHeight / height_ * (eye() - place).dot(axes().row(2).transpose());
}

output::Viewpoint Camera::viewpoint() const {
  return {eye() - target_, up(), output::Viewpoint::Eye{eye(), target_, 2 * kHalfAngle, true}};
}

output::Camera Camera::fitted_to(const Eigen::AlignedBox3d& box) const {
  output::Camera camera(viewpoint());
  for (int k = 0; k < kCorners; ++k) {
    const Eigen::Vector3f corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)).cast<float>();
    camera.see({&corner, 1});
  }
  camera.fit({0, 0, width(), height()});
  return camera;
}

}  // namespace hexaplast::view
