// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

using CornerTensors = std::array<Mat3, kCorners>;

/// Symmetric ones: xx, yy, zz, yz, zx, xy of each.
using CornerSymmetric = std::array<std::array<double, 6>, kCorners>;

}  // namespace hexaplast
