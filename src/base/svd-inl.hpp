// SPDX-License-Identifier: LGPL-2.1-or-later
// Singular value decomposition of 3 x 3 matrices by Jacobi rotations, for matrices in lanes and for one matrix.
#if defined(HEXAPLAST_BASE_SVD_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_BASE_SVD_INL
#undef HEXAPLAST_BASE_SVD_INL
#else
#define HEXAPLAST_BASE_SVD_INL
#endif

#include "base/lanes-inl.hpp"
#include "base/matrix-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// F = sum_k d_k u_k v_k^T. The rows u_k of U and v_k of V are right-handed, d descends in magnitude, and d_2 < 0 where
/// det F < 0.
template <class N>
struct SvdOf {
  Mat<N> U;
  N d[3];
  Mat<N> V;
};

/// Turns rows p and q of A, and of V with them, until they are orthogonal and p is not the shorter one. Returns whether
/// there was anything to do.
template <class N>
HEXAPLAST_INLINE bool turn_rows(int p, int q, Mat<N>& A, Mat<N>& V) {
  using T = ScalarOf<N>;
  constexpr T kOrthogonal = sizeof(T) == 8 ? T(1e-15) : T(5e-7);  // cosine of the angle between them
  constexpr T kTiny = sizeof(T) == 8 ? T(1e-300) : T(1e-37);
  const N pp = dot(A.m[p], A.m[p]), qq = dot(A.m[q], A.m[q]), pq = dot(A.m[p], A.m[q]), gap = pp - qq;
  const auto turns = pq * pq > N(kOrthogonal * kOrthogonal) * pp * qq, swaps = gap < N(T(0));
  if ((bits<T>(turns) | bits<T>(swaps)) == 0) return false;
  const N twice = pq + pq;
  const N tangent = select(turns, twice / max(abs(gap) + sqrt(gap * gap + twice * twice), N(kTiny)), N(T(0)));
  const N large = N(T(1)) / sqrt(N(T(1)) + tangent * tangent), small = tangent * large;
  const N cosine = select(swaps, small, large), sine = select(swaps, large, small);
  const auto turn = [&](Mat<N> & M) __attribute__((always_inline)) {
    for (int i = 0; i < 3; ++i) {
      const N of_p = M(p, i), of_q = M(q, i);
      M(p, i) = cosine * of_p + sine * of_q;
      M(q, i) = cosine * of_q - sine * of_p;
    }
  };
  turn(A);
  turn(V);
  return true;
}

/// One-sided Jacobi rotations (Hestenes 1958): V turns the columns of F until they are orthogonal. Errors are those of
/// rounding beside the largest stretch, or less: J. Demmel, K. Veselic, Jacobi's method is more accurate than QR, 1992.
/// Where stretches vanish, the u that F leaves open are near the v, so that U V^T turns little. Entries of F: up to
/// 1e307, in single precision 1e37; where some is no number, nothing is.
template <class N>
HEXAPLAST_INLINE SvdOf<N> signed_svd(const Mat<N>& F) {
  using T = ScalarOf<N>;
  constexpr int kMostSweeps = 12;  // five are enough nearly always
  constexpr T kSmallest = sizeof(T) == 8 ? T(1e-300) : T(1e-37);
  constexpr T kVanishing = sizeof(T) == 8 ? T(1e-15) : T(5e-7);  // of the largest stretch: rounding
  N size = abs(F(0, 0));
  for (int k = 1; k < 9; ++k) size += abs(F(k / 3, k % 3));
  const N scale = N(T(1)) / max(size, N(kSmallest)), none = size - size;  // no number where some entry is none
  Mat<N> A, V;                                                            // rows: columns of F V, and of V
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      A(i, j) = scale * F(j, i);
      V(i, j) = N(T(i == j ? 1 : 0)) + none;
    }
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    bool has_turned = turn_rows(0, 1, A, V);
    has_turned |= turn_rows(0, 2, A, V);
    has_turned |= turn_rows(1, 2, A, V);
    if (!has_turned) break;
  }

  Mat<N> U;
  const N first = sqrt(dot(A.m[0], A.m[0])), second = sqrt(dot(A.m[1], A.m[1]));
  const auto is_all = first > N(T(0));
  for (int i = 0; i < 3; ++i) U(0, i) = select(is_all, A(0, i) / max(first, N(kSmallest)), V(0, i));
  // the second one: of F V, or whichever of the v is not along the first
  const N along = dot(V.m[1], U.m[0]);
  const auto is_across = along * along<N(T(0.5)), has_second = second> N(kVanishing) * first;
  N b[3];
  for (int i = 0; i < 3; ++i)
    b[i] = select(has_second, A(1, i) / max(second, N(kSmallest)), select(is_across, V(1, i), V(2, i)));
  const N overlap = dot(b, U.m[0]);
  for (int i = 0; i < 3; ++i) b[i] -= overlap * U(0, i);
  const N length = sqrt(dot(b, b));
  for (int i = 0; i < 3; ++i) U(1, i) = b[i] / length;
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    U(2, i) = U(0, k) * U(1, l) - U(0, l) * U(1, k);
  }
  const N back = max(size, N(kSmallest)) + none;
  return {U, {back * first, back * second, back * dot(A.m[2], U.m[2])}, V};
}

/// sum_k numbers_k v_k v_k^T, v_k the rows of V.
template <class N>
HEXAPLAST_INLINE Sym<N> along_axes(const N (&numbers)[3], const Mat<N>& V) {
  Mat<N> scaled;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) scaled(k, i) = numbers[k] * V(k, i);
  const Mat<N> sum = transposed_product(V, scaled);
  return {sum(0, 0), sum(1, 1), sum(2, 2), sum(1, 2), sum(2, 0), sum(0, 1)};
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
