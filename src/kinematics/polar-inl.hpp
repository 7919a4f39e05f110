// SPDX-License-Identifier: LGPL-2.1-or-later
// Polar decomposition, one matrix per SIMD lane.                                              theory.md section 9.2
#if defined(HEXAPLAST_KINEMATICS_POLAR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_KINEMATICS_POLAR_INL
#undef HEXAPLAST_KINEMATICS_POLAR_INL
#else
#define HEXAPLAST_KINEMATICS_POLAR_INL
#endif

#include <concepts>

#include "base/svd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

template <class V>
struct PolarLanes {
  Mat<V> R;
  Sym<V> S;                ///< of F = R S
  std::uint32_t doubtful;  ///< bit per lane: too close to where the rotation is not unique; ask the SVD
};

/// The invariant I = s1 + s2 + s3 of the signed stretches is the largest root of
///
///   I^4 - 2 |F|^2 I^2 - 8 det(F) I + |F|^4 - 4 |cof F|^2 = 0
///
/// and with II = (I^2 - |F|^2) / 2, III = det F the rotation is
///
///   R = [ I cof F + (I^2 - II) F - F F^T F ] / (I II - III).                                                eq. 51
///
/// The denominator (s1 + s2)(s2 + s3)(s3 + s1) vanishes only where the rotation itself is not unique.
///
/// Of kCount matrices at once: the iteration for I is a chain of divisions, and one chain alone would leave the
/// processor waiting.
template <int kCount, class V>
HEXAPLAST_INLINE void polars(const Mat<V>* given, PolarLanes<V>* out) {
  using T = ScalarOf<V>;
  constexpr int kSteps = 4;
  constexpr T kSmallest = sizeof(T) == 8 ? T(1e-290) : T(1e-30);     // entries are brought to 1, unless all are smaller
  constexpr T kMinDenominator = sizeof(T) == 8 ? T(2e-3) : T(2e-2);  // of I^3
  constexpr T kConverged = sizeof(T) == 8 ? T(1e-6) : T(1e-3);       // of I, in the last step: the one after cubes it

  struct Invariants {
    V n2, det, constant;
    V I, step;
  } of[kCount];
  Mat<V> F[kCount], cof[kCount];
  for (int m = 0; m < kCount; ++m) {
    V size = abs(given[m](0, 0));
    for (int k = 1; k < 9; ++k) size = max(size, abs(given[m](k / 3, k % 3)));
    const V scale = V(T(1)) / max(size, V(kSmallest));
    for (int k = 0; k < 9; ++k) F[m].m[k / 3][k % 3] = scale * given[m].m[k / 3][k % 3];
    cof[m] = cofactor(F[m]);
    of[m].n2 = dot(F[m], F[m]);
    of[m].det = F[m](0, 0) * cof[m](0, 0) + F[m](0, 1) * cof[m](0, 1) + F[m](0, 2) * cof[m](0, 2);
    of[m].constant = of[m].n2 * of[m].n2 - V(T(4)) * dot(cof[m], cof[m]);
    of[m].I = sqrt(V(T(3)) * of[m].n2);
    of[m].step = of[m].I;
  }

  // Halley's method: all roots are real, so that it comes down to the largest one without passing it
  for (int k = 0; k < kSteps; ++k)
    for (Invariants& at : of) {
      const V I2 = at.I * at.I, difference = I2 - at.n2;
      const V value = (difference - at.n2) * I2 - V(T(8)) * at.det * at.I + at.constant;
      const V slope = V(T(4)) * (difference * at.I - (at.det + at.det));
      const V half_bend = V(T(6)) * I2 - (at.n2 + at.n2);
      at.step = value * slope / (slope * slope - value * half_bend);
      at.I -= at.step;
    }

  for (int m = 0; m < kCount; ++m) {
    const auto& [n2, det, constant, I, step] = of[m];
    const V II = V(T(0.5)) * (I * I - n2);
    const V denominator = I * II - det;
    const V cube = I * I * I;
    // written so that NaN is doubtful
    const auto fine =
        both(n2 > V(T(0.5)), both(denominator > V(kMinDenominator) * cube, abs(step) < V(kConverged) * I));
    out[m].doubtful = bits<T>(not_of(fine));

    const Mat<V> FtF = transposed_product(F[m], F[m]), FFtF = F[m] * FtF;
    const V inverse = V(T(1)) / denominator, linear = I * I - II;
    Mat<V> R;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R(i, j) = inverse * (I * cof[m](i, j) + linear * F[m](i, j) - FFtF(i, j));

    // one Newton-Schulz step makes R orthogonal to rounding: R <- R + R (I - R^T R) / 2
    const Mat<V> RtR = transposed_product(R, R);
    Mat<V> half;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) half(i, j) = V(T(i == j ? 1.5 : 0)) - V(T(0.5)) * RtR(i, j);
    out[m].R = R * half;

    const Mat<V> S = transposed_product(out[m].R, given[m]);
    out[m].S = {S(0, 0),
                S(1, 1),
                S(2, 2),
                V(T(0.5)) * (S(1, 2) + S(2, 1)),
                V(T(0.5)) * (S(2, 0) + S(0, 2)),
                V(T(0.5)) * (S(0, 1) + S(1, 0))};
  }
}
inline constexpr int kAtOnce = 4;

template <class V>
HEXAPLAST_INLINE PolarLanes<V> polar(const Mat<V>& F) {
  PolarLanes<V> out[1];
  polars<1>(&F, out);
  return out[0];
}

/// By the singular value decomposition: R = U V^T, S = V diag(d) V^T.                                           eq. 6
template <class N>
HEXAPLAST_NOINLINE PolarLanes<N> polar_by_svd(const Mat<N>& F) {
  const SvdOf<N> svd = signed_svd(F);
  return {transposed_product(svd.U, svd.V), along_axes(svd.d, svd.V), 0};
}

/// The same of the lanes that are doubtful.
template <class V>
HEXAPLAST_NOINLINE void replace_doubtful(const Mat<V>& F, PolarLanes<V>& polar) {
  const PolarLanes<V> found = polar_by_svd(F);
  polar.R = select_bits(polar.doubtful, found.R, polar.R);
  polar.S = select_bits(polar.doubtful, found.S, polar.S);
}

/// By the closed form, and where that leaves the rotation open by the singular value decomposition.
template <int kCount, class V>
HEXAPLAST_NOINLINE void safe_polars(const Mat<V>* F, PolarLanes<V>* out) {
  polars<kCount>(F, out);
  for (int m = 0; m < kCount; ++m)
    if (out[m].doubtful != 0) [[unlikely]]
      replace_doubtful(F[m], out[m]);
}
/// Of single matrices by the singular value decomposition.
template <int kCount, std::same_as<double> N>
HEXAPLAST_INLINE void safe_polars(const Mat<N>* F, PolarLanes<N>* out) {
  for (int m = 0; m < kCount; ++m) out[m] = polar_by_svd(F[m]);
}
template <class V>
HEXAPLAST_INLINE PolarLanes<V> safe_polar(const Mat<V>& F) {
  PolarLanes<V> out[1];
  safe_polars<1>(&F, out);
  return out[0];
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
