// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "picture/geometry.hpp"

namespace hexaplast::output {

/// An arrow in space: a shaft with a cone at its end.
struct Arrow {
  Eigen::Vector3f from, to;  ///< [m]
  float girth;               ///< [m] diameter of the shaft, where the arrow is long enough for one so thick

  void draw(Geometry::Vertices& triangles) const;  ///< adds it
};

}  // namespace hexaplast::output
