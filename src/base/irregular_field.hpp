// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// A field of numbers in [0, 1) without any regularity, the same in every run: no symmetry of a mesh is blind to it.
inline void fill_irregularly(PointArray& field) {
  constexpr double kGoldenRatio = 1.6180339887498949;  // its multiples fill [0, 1) without a pattern
  for (Eigen::Index i = 0; i < field.size(); ++i) {
    const double multiple = static_cast<double>(i + 1) * kGoldenRatio;
    field.data()[i] = multiple - std::floor(multiple);
  }
}

}  // namespace hexaplast
