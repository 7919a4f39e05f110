// SPDX-License-Identifier: LGPL-2.1-or-later
// Elementary functions over the ranges that formulas need, within 2 units in the last place. The coefficients are those
// of fdlibm (Sun Microsystems, 1993), made for double precision; single precision rounds them.
#if defined(HEXAPLAST_BASE_ELEMENTARY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_ELEMENTARY_INL
#undef HEXAPLAST_BASE_ELEMENTARY_INL
#else
#define HEXAPLAST_BASE_ELEMENTARY_INL
#endif

#include "base/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// c_0 + c_1 z + c_2 z^2 + ...
template <class N, int kTerms>
HEXAPLAST_INLINE N polynomial(const double (&c)[kTerms], N z) {
  using T = ScalarOf<N>;
  N sum(static_cast<T>(c[kTerms - 1]));
  for (int k = kTerms - 2; k >= 0; --k) sum = sum * z + N(static_cast<T>(c[k]));
  return sum;
}

/// Natural logarithm of positive numbers that are not subnormal; infinity and NaN are themselves.
///
///   log a = k log 2 + log(1 + f),  log(1 + f) = 2 atanh s = f - f^2/2 + s (f^2/2 + z P(z)),  s = f / (2 + f), z = s^2
template <class N>
HEXAPLAST_INLINE N log(N a) {
  using T = ScalarOf<N>;
  static constexpr double kP[] = {6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
                                  2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
                                  1.479819860511658591e-01};
  const N head(T(0x1.62e3p-1)), tail(T(9.058001351559417232e-06));  // of log 2; k times the head is exact
  N k;
  const N f = split(a, k) - N(T(1)), s = f / (f + N(T(2))), z = s * s, h = N(T(0.5)) * f * f;
  const N found = k * head - ((h - (s * (h + z * polynomial(kP, z)) + k * tail)) - f);
  return select(a < N(std::numeric_limits<T>::infinity()), found, a);
}

/// Arc tangent of numbers up to tan(pi / 8) = sqrt(2) - 1 in magnitude.
template <class N>
HEXAPLAST_INLINE N atan(N a) {
  static constexpr double kP[] = {3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
                                  -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
                                  6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
                                  -3.65315727442169155270e-02, 1.62858201153657823623e-02};
  const N z = a * a;
  return a - a * z * polynomial(kP, z);
}

/// Sine of angles up to pi / 4 in magnitude.
template <class N>
HEXAPLAST_INLINE N sin(N a) {
  static constexpr double kP[] = {-1.66666666666666324348e-01, 8.33333333332248946124e-03,  -1.98412698298579493134e-04,
                                  2.75573137070700676789e-06,  -2.50507602534068634195e-08, 1.58969099521155010221e-10};
  const N z = a * a;
  return a + a * z * polynomial(kP, z);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
