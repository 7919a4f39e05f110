// SPDX-License-Identifier: LGPL-2.1-or-later
// Logarithm and power of rotations, for rotations in lanes and for one rotation.
#if defined(HEXAPLAST_KINEMATICS_ROTATION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_KINEMATICS_ROTATION_INL
#undef HEXAPLAST_KINEMATICS_ROTATION_INL
#else
#define HEXAPLAST_KINEMATICS_ROTATION_INL
#endif

#include <cmath>
#include <concepts>

#include "base/lanes-inl.hpp"
#include "base/matrix-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Rotation vector: axis times angle.
template <class N>
struct RotationVector {
  N axis_angle[3];
  N angle;                           ///< [rad] in [0, pi]
  std::uint32_t near_half_turn = 0;  ///< bit per lane: the axis is lost in rounding; ask the quaternion
};

// Lanes use sine and cosine. The quaternion is accurate for the smallest angles and at pi, but finding it branches;
// tests/elastic/kernels_test.cpp compares the two.
template <class V>
HEXAPLAST_INLINE RotationVector<V> rotation_log(const Mat<V>& R) {
  using T = ScalarOf<V>;
  constexpr T kTiny = sizeof(T) == 8 ? T(1e-150) : T(1e-18);  // its square is above the smallest number
  const V cosine = V(0.5) * (R(0, 0) + R(1, 1) + R(2, 2) - V(1.0));
  RotationVector<V> out;
  out.axis_angle[0] = V(0.5) * (R(2, 1) - R(1, 2));
  out.axis_angle[1] = V(0.5) * (R(0, 2) - R(2, 0));
  out.axis_angle[2] = V(0.5) * (R(1, 0) - R(0, 1));
  const V sine = sqrt(out.axis_angle[0] * out.axis_angle[0] + out.axis_angle[1] * out.axis_angle[1] +
                      out.axis_angle[2] * out.axis_angle[2]);
  out.near_half_turn = bits<T>(not_of(cosine > V(-0.9)));

  // atan2 with the quotient kept below 1
  const auto steep = sine > abs(cosine);
  const V quotient = select(steep, cosine, sine) / select(steep, sine, max(abs(cosine), V(kTiny)));
  const V arc = atan(quotient), half_turn(3.14159265358979323846);
  out.angle = select(steep, V(0.5) * half_turn - arc, select(cosine < V(0.0), half_turn - arc, arc));
  const V stretch = select(sine > V(kTiny), out.angle / max(sine, V(kTiny)), V(1.0));
  for (V& component : out.axis_angle) component *= stretch;
  return out;
}
template <std::same_as<double> N>
HEXAPLAST_INLINE RotationVector<N> rotation_log(const Mat<N>& R) {
  N v[3], w;  // the quaternion (v, w), its largest component first
  const N trace = R(0, 0) + R(1, 1) + R(2, 2);
  if (trace > 0) {
    const N root = std::sqrt(trace + 1);
    w = 0.5 * root;
    for (int i = 0; i < 3; ++i) v[i] = 0.5 / root * (R((i + 2) % 3, (i + 1) % 3) - R((i + 1) % 3, (i + 2) % 3));
  } else {
    int i = R(1, 1) > R(0, 0) ? 1 : 0;
    if (R(2, 2) > R(i, i)) i = 2;
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    const N root = std::sqrt(R(i, i) - R(k, k) - R(l, l) + 1), scale = 0.5 / root;
    v[i] = 0.5 * root;
    v[k] = scale * (R(k, i) + R(i, k));
    v[l] = scale * (R(l, i) + R(i, l));
    w = scale * (R(l, k) - R(k, l));
  }
  const N sine = std::sqrt(dot(v, v));
  if (sine == 0) return {{0, 0, 0}, 0};
  const N angle = 2 * std::atan2(sine, std::abs(w)), stretch = std::copysign(angle / sine, w);
  return {{stretch * v[0], stretch * v[1], stretch * v[2]}, angle};
}

/// exp(fraction w) - 1.                                                                                          eq. 26
template <class N>
HEXAPLAST_INLINE Mat<N> rotation_expm1(const RotationVector<N>& w, N fraction) {
  const N half = N(0.5) * fraction * w.angle, small(1e-8), sine = sin(half), cosine = cos(half);
  // q = (cos, axis sin): the axis is w / angle, and sin / half -> 1
  const N ratio = N(0.5) * fraction * select(half > small, sine / max(half, small), N(1.0));
  const N x = ratio * w.axis_angle[0], y = ratio * w.axis_angle[1], z = ratio * w.axis_angle[2];
  const N two(2.0);
  return {{{-two * (y * y + z * z), two * (x * y - cosine * z), two * (x * z + cosine * y)},
           {two * (x * y + cosine * z), -two * (x * x + z * z), two * (y * z - cosine * x)},
           {two * (x * z - cosine * y), two * (y * z + cosine * x), -two * (x * x + y * y)}}};
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
