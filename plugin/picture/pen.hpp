// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "picture/camera.hpp"
#include "picture/renderer.hpp"

namespace hexaplast::output {

/// A place [m] with its colour, not yet on the page.
struct Corner {
  Eigen::Vector3f place;
  Colour colour;
};

Corner operator*(float factor, const Corner& corner);
Corner operator+(const Corner& a, const Corner& b);

Colour operator*(float factor, const Colour& colour);

inline double height(const Plane& plane, const Eigen::Vector3f& place) { return plane.height(place.cast<double>()); }

/// Hands out the parts of a triangle that lie above all planes.
template <class Take>
void for_each_part(const std::array<Corner, 3>& triangle, std::span<const Plane> above, const Take& take) {
  if (above.empty()) {
    take(triangle);
    return;
  }
  const Plane& plane = above.front();
  std::array<TriangleWeights, 4> part;
  const int count = part_above(
      {height(plane, triangle[0].place), height(plane, triangle[1].place), height(plane, triangle[2].place)}, part);
  const auto corner = [&](int k) {
    const auto factor = [&](int c) { return static_cast<float>(part[k][c]); };
    return factor(0) * triangle[0] + factor(1) * triangle[1] + factor(2) * triangle[2];
  };
  for (int k = 2; k < count; ++k) for_each_part({corner(0), corner(k - 1), corner(k)}, above.subspan(1), take);
}

/// Draws what lies in front of the camera, and in what is left of a body that is cut.
class Pen {
 public:
  /// Which things hide which: those that are farther away, or all others whatever lies between.
  enum class Layer { kInSpace, kBehind, kInFront };

  /// above: what lies below one of these is not drawn.
  Pen(const Camera& camera, std::vector<Plane> above, Drawing& picture, Layer layer = Layer::kInSpace)
      : camera_(camera), above_(std::move(above)), picture_(picture), layer_(layer) {}

  void fill(const std::array<Corner, 3>& triangle) const;
  void line(Corner from, Corner to, float width, float opacity) const;

  /// Whether a place is seen at all.
  bool reaches(const Eigen::Vector3f& place) const;

 private:
  Drawing::Vertex vertex(const Corner& corner) const;

  const Camera& camera_;
  std::vector<Plane> above_;
  Drawing& picture_;
  Layer layer_;
};

}  // namespace hexaplast::output
