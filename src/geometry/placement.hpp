// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Scales points along the axes, then turns them about x, y and z in this order [deg], then moves them [m]. What
/// changes nothing leaves the last bit alone.
void place(PointArray& points, const Vec3& scale, const Vec3& degrees, const Vec3& translation);

}  // namespace hexaplast
