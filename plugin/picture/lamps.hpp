// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "picture/camera.hpp"
#include "picture/geometry.hpp"

namespace hexaplast::output {

/// Lamps and what fraction of the light each of them gives: that of all together makes the brightest normal 1.
std::pair<std::vector<Eigen::Matrix3f>, std::vector<float>> lamps_and_strengths(int count);

/// Turns places so that the viewer looks along them, and the bodies around [0, 0, 0] reach to 1, free of the rim.
Eigen::Matrix4f seen_by(const Camera& camera, const Geometry& geometry, int map_size);

}  // namespace hexaplast::output
