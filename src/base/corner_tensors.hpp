// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

using CornerTensors = std::array<Mat3, kCorners>;

}  // namespace hexaplast
