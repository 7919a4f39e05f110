// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/camera.hpp"

#include <cmath>
#include <numbers>

namespace hexaplast::output {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kAzimuth = 24 * kDegree;  // of the viewer to the right of the body's side, and above it
constexpr double kElevation = 22 * kDegree;
constexpr float kFlat = 1e-3f;     // smallest depth of what is shown, in parts of its size
constexpr float kClosest = 0.02f;  // at which something is seen, in parts of the distance that is looked at

}  // namespace

Viewpoint beside(int long_axis) {
  const Vec3 upright = Vec3::Unit(long_axis == 1 ? 2 : 1);
  const Vec3 along = Vec3::Unit(long_axis), side = along.cross(upright);
  return {.towards = std::cos(kElevation) * (std::cos(kAzimuth) * side + std::sin(kAzimuth) * along) +
                     std::sin(kElevation) * upright,
          .up = upright};
}

Camera::Camera(const Viewpoint& viewpoint)
    : eye_(viewpoint.eye), towards_(viewpoint.towards.normalized().cast<float>()) {
  Vector3f upright = viewpoint.up.value_or(Vec3::UnitY()).normalized().cast<float>();
  for (const Vector3f& other : {Vector3f(-Vector3f::UnitZ()), Vector3f(Vector3f::UnitY())})
    if (upright.cross(towards_).norm() < 1e-3f) upright = other;  // seen from above, or from below
  right_ = upright.cross(towards_).normalized();
  up_ = towards_.cross(right_);
}

void Camera::see(std::span<const Vector3f> points) {
  for (const Vector3f& point : points) seen_.extend(Vector3f(right_.dot(point), up_.dot(point), towards_.dot(point)));
}

void Camera::see_depths(std::span<const Vector3f> points) {
  for (const Vector3f& point : points) {
    front_depth_ = std::max(front_depth_, towards_.dot(point));
    back_depth_ = std::min(back_depth_, towards_.dot(point));
  }
}

void Camera::fit(const Window& window) {
  middle_ = {window.left + window.width / 2, window.top + window.height / 2};
  nearest_ = std::max(seen_.max().z(), front_depth_);
  farthest_ = std::min({seen_.min().z(), back_depth_, nearest_ - kFlat * seen_.sizes().norm()});
  if (!eye_) {
    centre_ = seen_.center().head<2>();
    scale_ = std::min(window.width / seen_.sizes().x(), window.height / seen_.sizes().y());
    return;
  }

  const Vector3f target = eye_->looks_at.cast<float>();
  const float away = static_cast<float>((eye_->position - eye_->looks_at).norm());
  centre_ = {right_.dot(target), up_.dot(target)};
  scale_ = window.height / (2 * away * static_cast<float>(std::tan(eye_->field_of_view * kDegree / 2)));
  if (!eye_->is_perspective) return;
  distance_ = away;
  eye_depth_ = towards_.dot(eye_->position.cast<float>());
  const float closest = kClosest * away;
  front_ = Plane{-towards_.cast<double>(), static_cast<double>(closest - eye_depth_)};
  // across a triangle depth changes evenly on the page as one over the distance does
  nearest_ = 1 / std::max(closest, eye_depth_ - nearest_);
  farthest_ = std::min(1 / std::max(closest, eye_depth_ - farthest_), nearest_ * (1 - kFlat));
}

Drawing::Vertex Camera::project(const Vector3f& point) const {
  float depth = towards_.dot(point), scale = scale_;
  if (distance_ > 0) {
    depth = 1 / (eye_depth_ - depth);
    scale *= distance_ * depth;
  }
  return {.x = middle_.x() + scale * (right_.dot(point) - centre_.x()),
          .y = middle_.y() - scale * (up_.dot(point) - centre_.y()),
          .depth = 0.1f + 0.8f * (nearest_ - depth) / (nearest_ - farthest_),
          .colour = {}};
}

}  // namespace hexaplast::output
