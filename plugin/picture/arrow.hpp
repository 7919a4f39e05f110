// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "picture/pen.hpp"

namespace hexaplast::output {

/// An arrow in space: a shaft with a cone at its end.
struct Arrow {
  Eigen::Vector3f from, to;  ///< [m]
  float girth;               ///< [m] diameter of the shaft, where the arrow is long enough for one so thick
  Colour colour;

  struct Vertex {
    Eigen::Vector3f place, normal;  ///< [m], unit vector
  };
  using Face = std::array<Vertex, 3>;
  std::vector<Face> faces() const;

  void draw(const Camera& camera, const Pen& pen) const;
};

/// How forces become arrows.
struct ArrowScale {
  float longest = 0, force = 0;  ///< [m] of the longest arrow, and the force [N] that it stands for
  float girth = 0;               ///< [m] of all of them

  /// Of a load at a place of a surface with this normal of any length: one that presses points at its place from
  /// outside, any other starts there.
  Arrow of_load(const Eigen::Vector3f& place, const Eigen::Vector3f& load, const Eigen::Vector3f& outwards) const;

  /// Of an instrument's force on the body: it starts where that acts.
  Arrow of_tool(const Eigen::Vector3f& place, const Eigen::Vector3f& load) const;
};

}  // namespace hexaplast::output
