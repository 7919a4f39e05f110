// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast::output {

/// Light from a whole hemisphere, and how much of it bodies keep from each other: soft shadows, and darkness in
/// hollows. The hemisphere is a fixed set of far lamps; for each of them a map of depths tells what it reaches.
class Lighting {
 public:
  /// up, towards: unit vectors of the picture; `towards` points at the viewer.
  Lighting(const Eigen::Vector3f& up, const Eigen::Vector3f& towards);

  /// What lies in the light from now on: triangles of points [m].
  void place(std::span<const Eigen::Vector3f> points, std::span<const Triangle> triangles);

  /// Fraction of the light that a place [m] with a unit normal receives: 1 where nothing stands before the lamps and
  /// the normal points where most of them are, 0 in darkness.
  float received(const Eigen::Vector3f& place, const Eigen::Vector3f& normal) const;

 private:
  struct Lamp {
    Eigen::Vector3f right, up, towards;  // unit vectors; `towards` points at the lamp
    float strength = 0;                  // that of all lamps together makes the brightest normal 1
    Eigen::Vector2f corner = {0, 0};     // [m] lower left corner of the map, along right and up
    std::vector<float> depth;            // [m] along `towards`, of what is nearest to the lamp; kMapSize x kMapSize
  };

  void draw(Lamp& lamp, std::span<const Eigen::Vector3f> points, std::span<const Triangle> triangles) const;
  float reach(const Lamp& lamp, const Eigen::Vector3f& place) const;  // fraction of a lamp's light that arrives

  std::vector<Lamp> lamps_;
  float texel_ = 1;  // [m] of all maps
};

}  // namespace hexaplast::output
