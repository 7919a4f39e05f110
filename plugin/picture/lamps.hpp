// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>

#include "picture/camera.hpp"
#include "picture/geometry.hpp"

namespace hexaplast::output {

// of maps of depths [texels]
inline constexpr int kMapSize = 1024;  // of the main lamp, per direction
inline constexpr float kLift = 1.5f;   // that a place is looked at above its surface, so that it shades not itself
inline constexpr float kSlack = 1;     // by which something must be nearer to the lamp to cast a shadow

/// Turns places so that the viewer looks along them, and the bodies around [0, 0, 0] reach to 1, free of the rim of a
/// map of depths.
Eigen::Matrix4f seen_by(const Camera& camera, const Geometry& geometry, int map_size);

/// Rows to the right, up and towards a lamp, seen from the viewer.
Eigen::Matrix3f turned_to(const Eigen::Vector3f& lamp);

/// Gives the vertices of tissue what they receive of the light of many lamps all over the hemisphere, as far as tissue
/// does not keep it from them; all of it is 1. Instruments keep no light from it, so that its colours can be compared.
void light_up(Geometry& geometry, const Camera& camera);

}  // namespace hexaplast::output
