// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hexaplast::output {
namespace {

using Eigen::Vector3f;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kAzimuth = 24 * kDegree;  // of the viewer to the right of the body's side, and above it
constexpr double kElevation = 22 * kDegree;
constexpr double kUpright = 0.9;      // cosine of the angle to up, from which an axis is upright
constexpr double kFlat = 1e-3;        // smallest depth of what is shown, in parts of its size
constexpr double kDepthRange = 0.98;  // of what OpenGL offers: rounding cuts nothing off
constexpr double kClosest = 0.02;     // at which something is seen, in parts of the distance that is looked at

}  // namespace

Mat3 standing(const Vec3& up) {
  const Vec3 upright = up.normalized();
  const Vec3 x = Vec3::Unit(std::abs(upright.x()) < kUpright ? 0 : 2);
  const Vec3 right = (x - upright.dot(x) * upright).normalized();
  Mat3 rows;
  rows << right.transpose(), upright.transpose(), right.cross(upright).transpose();
  return rows;
}

std::optional<Vec3> side_named(std::string_view word, const Vec3& up) {
  constexpr std::array<std::string_view, 6> kSides{"right", "top", "front", "left", "bottom", "back"};
  const auto side = std::ranges::find(kSides, word) - kSides.begin();
  if (side == std::ssize(kSides)) return std::nullopt;
  return standing(up).row(side % 3).transpose() * (side < 3 ? 1 : -1);
}

Viewpoint beside(int long_axis, const Vec3& up) {
  const Vec3 upright = up.normalized();
  Vec3 along = Vec3::Unit(long_axis) - upright[long_axis] * upright;
  along = std::abs(upright[long_axis]) < kUpright ? Vec3(along.normalized()) : Vec3(standing(up).row(0).transpose());
  const Vec3 side = along.cross(upright);
  return {.towards = std::cos(kElevation) * (std::cos(kAzimuth) * side + std::sin(kAzimuth) * along) +
                     std::sin(kElevation) * upright,
          .up = upright};
}

Camera::Camera(const Viewpoint& viewpoint) : eye_(viewpoint.eye), towards_(viewpoint.towards.normalized()) {
  Vec3 upright = viewpoint.up.value_or(Vec3::UnitY()).normalized();
  for (const Vec3& other : {Vec3(-Vec3::UnitZ()), Vec3(Vec3::UnitY())})
    if (upright.cross(towards_).norm() < 1e-3) upright = other;  // seen from above, or from below
  right_ = upright.cross(towards_).normalized();
  up_ = towards_.cross(right_);
}

void Camera::see(std::span<const Vector3f> points) {
  for (const Vector3f& point : points) {
    const Vec3 place = point.cast<double>();
    seen_.extend(Vec3(right_.dot(place), up_.dot(place), towards_.dot(place)));
  }
}

void Camera::see_depths(std::span<const Vector3f> points) {
  for (const Vector3f& point : points) {
    const double depth = towards_.dot(point.cast<double>());
    front_depth_ = std::max(front_depth_, depth);
    back_depth_ = std::min(back_depth_, depth);
  }
}

void Camera::fit(const Window& window) {
  const double width = window.width, height = window.height;
  middle_ = {window.left + width / 2, window.top + height / 2};
  nearest_ = std::max(seen_.max().z(), front_depth_);
  farthest_ = std::min({seen_.min().z(), back_depth_, nearest_ - kFlat * seen_.sizes().norm()});
  if (!eye_) {
    centre_ = seen_.center().head<2>();
    scale_ = std::min(width / seen_.sizes().x(), height / seen_.sizes().y());
    return;
  }

  const double away = (eye_->position - eye_->looks_at).norm();
  centre_ = {right_.dot(eye_->looks_at), up_.dot(eye_->looks_at)};
  scale_ = height / (2 * away * std::tan(eye_->field_of_view * kDegree / 2));
  if (!eye_->is_perspective) return;
  distance_ = away;
  eye_depth_ = towards_.dot(eye_->position);
  closest_ = kClosest * away;
  // across a triangle depth changes evenly on the page as one over the distance does
  nearest_ = 1 / std::max(closest_, eye_depth_ - nearest_);
  farthest_ = std::min(1 / std::max(closest_, eye_depth_ - farthest_), nearest_ * (1 - kFlat));
}

bool Camera::is_before(const Vector3f& point) const {
  return !(distance_ > 0) || eye_depth_ - towards_.dot(point.cast<double>()) >= closest_;
}

Eigen::Vector2f Camera::on_page(const Vector3f& point) const {
  const Vec3 place = point.cast<double>();
  const double scale = distance_ > 0 ? scale_ * distance_ / (eye_depth_ - towards_.dot(place)) : scale_;
  const Eigen::Vector2d from_middle(right_.dot(place) - centre_.x(), centre_.y() - up_.dot(place));
  return (middle_ + scale * from_middle).cast<float>();
}

Eigen::Matrix4d Camera::clip(double width, double height) const {
  using Row = Eigen::RowVector4d;
  const auto row = [](const Vec3& factors, double rest) -> Row {
    return {factors.x(), factors.y(), factors.z(), rest};
  };
  const bool is_perspective = distance_ > 0;
  const Row one(0, 0, 0, 1), w = is_perspective ? row(-towards_, eye_depth_) : one;
  const double scale = is_perspective ? scale_ * distance_ : scale_;
  const Row x = middle_.x() * w + scale * row(right_, -centre_.x());
  const Row y = middle_.y() * w - scale * row(up_, -centre_.y());
  const Row depth =
      nearest_ * w - (is_perspective ? one : row(towards_, 0));  // 0 nearest, `nearest - farthest` farthest
  Eigen::Matrix4d matrix;
  matrix << 2 / width * x - w, w - 2 / height * y, kDepthRange * (2 / (nearest_ - farthest_) * depth - w), w;
  return matrix;
}

Eigen::Vector4d Camera::eye() const {
  return distance_ > 0 ? Eigen::Vector4d(eye_->position.homogeneous())
                       : Eigen::Vector4d(towards_.x(), towards_.y(), towards_.z(), 0);
}

}  // namespace hexaplast::output
