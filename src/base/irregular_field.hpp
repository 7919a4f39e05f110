// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// The i-th of numbers in [0, 1) without any regularity, the same in every run.
inline double irregular_number(Eigen::Index i) {
  constexpr double kGoldenRatio = 1.6180339887498949;  // its multiples fill [0, 1) without a pattern
  const double multiple = static_cast<double>(i + 1) * kGoldenRatio;
  return multiple - std::floor(multiple);
}

/// A field of such numbers: no symmetry of a mesh is blind to it.
inline void fill_irregularly(PointArray& field) {
  for (Eigen::Index i = 0; i < field.size(); ++i) field.data()[i] = irregular_number(i);
}

}  // namespace hexaplast
