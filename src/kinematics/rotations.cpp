// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the function at the end chooses at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinematics/rotations.cpp"
#include "hwy/foreach_target.h"
//
#include <algorithm>
#include <cassert>

#include "kinematics/polar-inl.hpp"
#include "kinematics/polar.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

void rotate_all(std::span<const Mat3> F, std::span<Mat3> R) {
  using V = Lanes<double>;
  alignas(64) double numbers[9][V::kCount];
  for (std::size_t first = 0; first < F.size(); first += V::kCount) {
    const std::size_t last = F.size() - 1;  // fills up the last register
    Mat<V> lanes;
    for (int k = 0; k < 9; ++k) {
      for (std::size_t lane = 0; lane < V::kCount; ++lane)
        numbers[k][lane] = F[std::min(first + lane, last)](k / 3, k % 3);
      lanes.m[k / 3][k % 3] = load(numbers[k]);
    }
    const PolarLanes<V> found = safe_polar(lanes);
    for (int k = 0; k < 9; ++k) store(found.R.m[k / 3][k % 3], numbers[k]);
    for (std::size_t lane = 0; lane < V::kCount && first + lane < F.size(); ++lane)
      for (int k = 0; k < 9; ++k) R[first + lane](k / 3, k % 3) = numbers[k][lane];
  }
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(rotate_all);

void rotations(std::span<const Mat3> F, std::span<Mat3> R) {
  assert(F.size() == R.size());
  HWY_DYNAMIC_DISPATCH(rotate_all)(F, R);
}

}  // namespace hexaplast
#endif
