// SPDX-License-Identifier: LGPL-2.1-or-later
// Plastic flow at a corner and restitution of volume, in lanes and for one corner.        theory.md sections 5.1 to 5.3
#if defined(HEXAPLAST_PLASTIC_POINT_FLOW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_PLASTIC_POINT_FLOW_INL
#undef HEXAPLAST_PLASTIC_POINT_FLOW_INL
#else
#define HEXAPLAST_PLASTIC_POINT_FLOW_INL
#endif

#include <cmath>
#include <concepts>

#include "base/svd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// clamp(rate dt (value - threshold) / size, 0, 1); 0 where value <= threshold.                         eq. 21, 25, 33
template <class N>
HEXAPLAST_INLINE N flow_fraction(N value, N threshold, N rate_dt, N size) {
  const N fraction = min(rate_dt * (value - threshold) / size, N(1.0));
  return select(value > threshold, fraction, N(0.0));
}

/// max(0, threshold + hardening fraction value); the threshold itself where nothing flows.                   eq. 23, 25
template <class N>
HEXAPLAST_INLINE N hardened(N threshold, N hardening, N fraction, N value) {
  // select: a threshold of infinity times a fraction of zero is no number
  return select(fraction > N(0.0), max(N(0.0), threshold + hardening * fraction * value), threshold);
}

/// log S minus its mean, in the axes (rows) of a stretch that is positive definite.
template <std::same_as<double> N>
struct LogStretches {
  HEXAPLAST_INLINE explicit LogStretches(const Sym<N>& S) {
    const SvdOf<N> svd = signed_svd(matrix(S));
    const N log[3] = {std::log(svd.d[0]), std::log(svd.d[1]), std::log(svd.d[2])},
            mean = (log[0] + log[1] + log[2]) / 3;
    for (int k = 0; k < 3; ++k) deviatoric[k] = log[k] - mean;
    axes = svd.V;
  }
  N deviatoric[3];
  Mat<N> axes;
};

/// How many terms of a power series leave out less than rounding, by the size of its argument.
struct SeriesLength {
  double size;  ///< the largest for which the terms suffice
  int terms;
};

template <class V, std::size_t kLengths>
HEXAPLAST_INLINE int terms_for(V size, const SeriesLength (&lengths)[kLengths]) {
  for (const SeriesLength& length : lengths)  // NaN in one lane takes all terms: those beside it are right
    if (all_true<ScalarOf<V>>(size < V(static_cast<ScalarOf<V>>(length.size)))) return length.terms;
  return lengths[kLengths - 1].terms;
}

/// log S minus its mean; fails: bit per lane, the series does not suffice.                                   eq. 53
///
///   log S = log m + 2 atanh Z,  Z = (S - m)(S + m)^-1,  m = tr S / 3
///
/// Powers of Z^2 beyond the second are taken down by its characteristic equation: three numbers per term.
template <class V>
HEXAPLAST_INLINE Mat<V> deviatoric_log(const Sym<V>& S, std::uint32_t& fails) {
  using T = ScalarOf<V>;
  // x^n / (2 n + 1) is below 2e-17, and in single precision below 1e-8
  static constexpr SeriesLength kDouble[] = {{1e-4, 4}, {2.5e-3, 6}, {0.012, 8}, {0.07, 13}, {0.2, 22}, {0.45, 44}};
  static constexpr SeriesLength kSingle[] = {{2e-4, 2}, {4e-3, 3}, {0.017, 4}, {0.07, 6}, {0.17, 9}, {0.45, 20}};
  constexpr const SeriesLength(&kLengths)[6] = sizeof(T) == 8 ? kDouble : kSingle;
  constexpr double kLargest = kLengths[5].size;  // of the largest eigenvalue of Z^2
  const V m = V(1.0 / 3) * (S.xx + S.yy + S.zz);
  const Mat<V> minus = matrix(Sym<V>{S.xx - m, S.yy - m, S.zz - m, S.yz, S.zx, S.xy});
  const Mat<V> plus = matrix(Sym<V>{S.xx + m, S.yy + m, S.zz + m, S.yz, S.zx, S.xy});
  V det;
  const Mat<V> Z = minus * reciprocal(plus, det);  // the reciprocal of a symmetric matrix is its inverse
  const Mat<V> W = Z * Z, WW = W * W;
  const V size = sqrt(sqrt(dot(WW, WW)));
  fails |= bits<T>(not_of(both(size<V(kLargest), m> V(0.0))));

  const V i1 = W(0, 0) + W(1, 1) + W(2, 2);
  const V i2 = V(0.5) * (i1 * i1 - dot(W, W));
  const Mat<V> cof = cofactor(W);
  const V i3 = W(0, 0) * cof(0, 0) + W(0, 1) * cof(0, 1) + W(0, 2) * cof(0, 2);
  const int terms = terms_for(size, kLengths);
  V a(1.0 / (2 * terms + 1)), b(0.0), c(0.0);  // a + b W + c W^2
  for (int k = terms - 1; k >= 0; --k) {
    const V above = c;
    c = b + above * i1;
    b = a - above * i2;
    a = above * i3 + V(1.0 / (2 * k + 1));
  }
  Mat<V> series;
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s) series(r, s) = (r == s ? a : V(0.0)) + b * W(r, s) + c * WW(r, s);
  Mat<V> log = Z * series;
  const V mean = V(1.0 / 3) * (log(0, 0) + log(1, 1) + log(2, 2));
  for (int k = 0; k < 3; ++k) log(k, k) -= mean;
  for (int k = 0; k < 9; ++k) log.m[k / 3][k % 3] *= V(2.0);
  return log;
}

/// Terms of exp M for |M|^2 = size; fails: bit per lane, the series does not suffice.
template <class V>
HEXAPLAST_INLINE int exponential_terms(V size, std::uint32_t& fails) {
  using T = ScalarOf<V>;
  // the first term left out is below 2e-16, those after it 2e-17; in single precision below 1e-8
  static constexpr SeriesLength kDouble[] = {{1e-5, 5}, {4e-4, 7}, {3e-3, 8}, {0.02, 10}, {0.5, 15}, {3, 24}};
  static constexpr SeriesLength kSingle[] = {{1e-5, 2}, {1e-4, 3}, {3e-3, 4}, {0.02, 6}, {0.5, 9}, {3, 14}};
  constexpr const SeriesLength(&kLengths)[6] = sizeof(T) == 8 ? kDouble : kSingle;
  fails |= bits<T>(not_of(size < V(static_cast<T>(kLengths[5].size))));
  return terms_for(size, kLengths);
}

/// exp M - 1 of a symmetric matrix without trace, by its characteristic equation M^3 = j M + d; fails: bit per lane,
/// the series does not suffice.                                                                              eq. 54
template <class V>
HEXAPLAST_INLINE Mat<V> expm1(const Mat<V>& M, std::uint32_t& fails) {
  const V size = dot(M, M);
  const int terms = exponential_terms(size, fails);
  const V j = V(0.5) * size;
  const Mat<V> cof = cofactor(M);
  const V d = M(0, 0) * cof(0, 0) + M(0, 1) * cof(0, 1) + M(0, 2) * cof(0, 2);
  V a(1.0), b(0.0), c(0.0);  // Horner: M (1 + M / 2 (1 + M / 3 (...)))
  for (int k = terms; k >= 2; --k) {
    const V scale(1.0 / k), above = c;
    c = scale * b;
    b = scale * (a + above * j);
    a = V(1.0) + scale * above * d;
  }
  const V above = c;
  c = b;
  b = a + above * j;
  a = above * d;
  const Mat<V> MM = M * M;
  Mat<V> E;
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s) E(r, s) = (r == s ? a : V(0.0)) + b * M(r, s) + c * MM(r, s);
  return E;
}

/// exp(fraction dev log S) - 1, and the logarithm of the power. Lanes need another form, because the search for
/// eigenvectors branches; tests/plain/plain_test.cpp compares the two.                        eq. 22
template <class V>
HEXAPLAST_INLINE Mat<V> stretch_power(const Sym<V>& S, V fraction, Mat<V>& log, std::uint32_t& fails) {
  log = deviatoric_log(S, fails);
  for (int k = 0; k < 9; ++k) log.m[k / 3][k % 3] *= fraction;
  return expm1(log, fails);
}
template <std::same_as<double> N>
HEXAPLAST_INLINE Mat<N> stretch_power(const Sym<N>& S, N fraction, Mat<N>& log, std::uint32_t& /*fails*/) {
  const LogStretches<N> of(S);
  N flowed[3], power[3];
  for (int k = 0; k < 3; ++k) {
    flowed[k] = fraction * of.deviatoric[k];
    power[k] = std::expm1(flowed[k]);
  }
  log = matrix(along_axes(flowed, of.axes));
  return matrix(along_axes(power, of.axes));
}

/// S^p - 1 of a corner of stretch S and stress sigma, of which the given fraction flows. Adds the plastic strain [-],
/// sqrt(2/3) fraction |dev log S|, and the dissipated energy [J/m^3], sigma : fraction dev log S. fails: bit per lane,
/// the series does not suffice.                                                                     eq. 22, section 5.8
template <class N>
HEXAPLAST_INLINE Mat<N> stretch_increment(const Sym<N>& S, const Sym<N>& sigma, N fraction, N& strain, N& dissipated,
                                          std::uint32_t& fails) {
  Mat<N> log;
  const Mat<N> increment = stretch_power(S, fraction, log, fails);
  dissipated += dot(matrix(sigma), log);
  strain += N(0.81649658092772603) * sqrt(dot(log, log));
  return increment;
}

inline constexpr double kVolumeAtRest = 1e-12;  ///< a relative volume error below is rounding

// lengths may not change more by restitution in one step, whatever beta
inline constexpr double kMinScale = 0.5, kGreatestScale = 2.0;

/// The factor of the lengths of a rest shape: 1 + c dt (1 - beta) within [1/2, 2], and 1 where beta is 1 but for
/// rounding.                                                                                                   eq. 28
template <class N>
HEXAPLAST_INLINE N restitution_scale(N volume_ratio, N rate_dt) {
  const N one(1.0);
  const N scale = min(max(one + rate_dt * (one - volume_ratio), N(kMinScale)), N(kGreatestScale));
  return select(abs(volume_ratio - one) < N(kVolumeAtRest), one, scale);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
