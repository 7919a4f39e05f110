// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "hexaplast/base/types.hpp"
#include "scene/seen.hpp"

namespace hexaplast::output {

using scene::Viewpoint;

/// How a scene wants pictures to be taken.
struct PictureRecord {
  bool shows_hexahedra = true;              ///< beside embedded surfaces: as edges
  bool shows_loads = true;                  ///< as arrows
  std::optional<Viewpoint> viewpoint = {};  ///< none: beside the long axis, and above
  Vec3 gravity = Vec3::Zero();              ///< [m/s^2] its direction is shown where it is not 0
  bool is_anatomical = false;               ///< x, y and z run to the left, the back and the head of a patient
  std::optional<Vec3> up = {};              ///< as somebody asks for it
};

/// The part of the page that a body is shown in, in units of the page.
struct Window {
  float left = 0, top = 0, width = 1, height = 1;
};

/// Turns places in space into places on the page.
class Camera {
 public:
  /// A camera that stands in a direction, and is not fitted to anything yet.
  explicit Camera(const Viewpoint& viewpoint);

  Eigen::Vector3f right() const { return right_.cast<float>(); }
  Eigen::Vector3f up() const { return up_.cast<float>(); }
  Eigen::Vector3f towards() const { return towards_.cast<float>(); }

  /// Takes in what is going to be shown [m].
  void see(std::span<const Eigen::Vector3f> points);

  /// Takes in what is shown if it lies in the picture, and is not a reason to show more: its depths alone.
  void see_depths(std::span<const Eigen::Vector3f> points);

  /// Fits what it has seen into the window: where the viewpoint has an eye only the depths, else the detail too.
  void fit(const Window& window);

  /// Units of the page per metre, in the middle of what is shown.
  float scale() const { return static_cast<float>(scale_); }

  /// Whether a place [m] lies before the viewer.
  bool is_before(const Eigen::Vector3f& point) const;

  /// Where on the page a place [m] before the viewer is seen.
  Eigen::Vector2f on_page(const Eigen::Vector3f& point) const;

  /// From homogeneous places [m] to clip coordinates of OpenGL, whose square is a page of this size.
  Eigen::Matrix4d clip(double width, double height) const;

  /// The viewer [m], or the direction to a viewer who is infinitely far away: homogeneous.
  Eigen::Vector4d eye() const;

 private:
  std::optional<Viewpoint::Eye> eye_;
  Vec3 right_, up_, towards_;                                      // unit vectors
  Eigen::AlignedBox3d seen_;                                       // [m] along these three
  double front_depth_ = -std::numeric_limits<double>::infinity();  // [m] along `towards`, of all that is drawn
  double back_depth_ = std::numeric_limits<double>::infinity();

  Eigen::Vector2d middle_ = {0, 0};  // of the window, on the page
  Eigen::Vector2d centre_ = {0, 0};  // [m] along right and up, of what is shown there
  double scale_ = 1;
  double distance_ = 0;                // [m] of a perspective camera from the plane in which `scale` holds; 0: parallel
  double eye_depth_ = 0;               // [m] along `towards`
  double closest_ = 0;                 // [m] from the eye, at which something is seen
  double nearest_ = 0, farthest_ = 1;  // [m] along `towards`; in perspective 1 / distance from the eye
};

/// How a body stands: rows to the right, up and to the front, unit vectors. To the right is x, unless that is up.
Mat3 standing(const Vec3& up);

/// Towards the viewer who looks at the "front", "back", "right", "left", "top" or "bottom" of a body; none: another
/// word.
std::optional<Vec3> side_named(std::string_view word, const Vec3& up);

/// Beside the long axis of a body, which runs to the right unless it is upright, and a little above.
Viewpoint beside(int long_axis, const Vec3& up = Vec3::UnitY());

}  // namespace hexaplast::output
