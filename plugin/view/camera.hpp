// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>

#include "geometry/pick.hpp"
#include "picture/camera.hpp"

namespace hexaplast::view {

/// A camera in perspective that turns about a target as on a turntable. Pixels: x to the right, y downwards, from the
/// upper left corner of the picture.
class Camera {
 public:
  /// up: the axis of the turntable; towards: from the target to the viewer. Neither is zero, nor are they parallel.
  Camera(const Vec3& up, const Vec3& towards);

  void resize(int width, int height);  ///< [pixels] of the picture
  /// Looks at a box [m] so that the whole of it is seen, above a strip [pixels].
  void fit(const Eigen::AlignedBox3d& box, double strip = 0);
  void orbit(double right, double down);  ///< by a way of the mouse [pixels]
  void pan(double right, double down);    ///< the target's plane follows the mouse [pixels]
  void zoom(double clicks);               ///< nearer by so many clicks of the wheel

  Ray ray(double x, double y) const;                              ///< from the viewer through a pixel
  Vec3 at_depth_of(const Vec3& place, double x, double y) const;  ///< [m] under a pixel, as far away as a place
  Eigen::Vector2d pixel_of(const Vec3& place) const;
  double metres_per_pixel(const Vec3& place) const;  ///< at the distance of a place

  Vec3 eye() const;                               ///< [m]
  const Vec3& target() const { return target_; }  ///< [m]
  Vec3 up() const { return axes().row(1).transpose(); }
  Mat3 axes() const;                                          ///< rows: right, up, towards
  float width() const { return static_cast<float>(width_); }  ///< [pixels]
  float height() const { return static_cast<float>(height_); }

  output::Viewpoint viewpoint() const;

  /// The same for pictures, whose depths are those of a box [m].
  output::Camera fitted_to(const Eigen::AlignedBox3d& box) const;

 private:
  Mat3 table_;                          // rows: two directions in the plane of the turntable, and its axis
  double azimuth_ = 0, elevation_ = 0;  // [rad]
  Vec3 target_ = Vec3::Zero();
  double distance_ = 1;  // [m]
  double width_ = 1, height_ = 1;
};

}  // namespace hexaplast::view
