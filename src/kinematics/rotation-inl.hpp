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

#include "base/elementary-inl.hpp"
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

// Lanes use sine and cosine. The quaternion is accurate for the smallest angles and at pi, but finding it branches.
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

  // by the tangent of a quarter of the angle, or of what it lacks of pi
  const V plus = V(1.0) + abs(cosine), acute = V(4.0) * atan(sine / (plus + sqrt(plus + plus)));
  out.angle = select(cosine < V(0.0), V(3.14159265358979323846) - acute, acute);
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

/// exp(fraction w) - 1, fraction in [0, 1].                                                                      eq. 26
template <class N>
HEXAPLAST_INLINE Mat<N> rotation_expm1(const RotationVector<N>& w, N fraction) {
  const N half = N(0.5) * fraction * w.angle, small(1e-8), one(1.0), two(2.0);
  const N of_quarter = sin(N(0.5) * half), sine = two * of_quarter * sqrt(one - of_quarter * of_quarter);
  // q = (cos, axis sin): the axis is w / angle, and sin / half -> 1
  const N cosine = one - two * of_quarter * of_quarter;
  const N ratio = N(0.5) * fraction * select(half > small, sine / max(half, small), one);
  const N x = ratio * w.axis_angle[0], y = ratio * w.axis_angle[1], z = ratio * w.axis_angle[2];
  return {{{-two * (y * y + z * z), two * (x * y - cosine * z), two * (x * z + cosine * y)},
           {two * (x * y + cosine * z), -two * (x * x + z * z), two * (y * z - cosine * x)},
           {two * (x * z - cosine * y), two * (y * z + cosine * x), -two * (x * x + y * y)}}};
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
