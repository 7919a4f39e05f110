// SPDX-License-Identifier: LGPL-2.1-or-later
// Isolated rest shapes: each sample i of a hexahedron has its own G_i = (F^p_i)^-1. For samples in lanes and for one
// sample, without lanes or matrices of other libraries.                                          theory.md section 5.9
#if defined(HEXAPLAST_ELEMENT_ISOLATED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELEMENT_ISOLATED_INL
#undef HEXAPLAST_ELEMENT_ISOLATED_INL
#else
#define HEXAPLAST_ELEMENT_ISOLATED_INL
#endif

#include "base/matrix-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// The lower triangular Gm with Gm Gm^T = mean_i G_i G_i^T.                                                    eq. P2
template <class N>
HEXAPLAST_INLINE Mat<N> mean_plastic_inverse(const Mat<N> (&G)[kCorners]) {
  Mat<N> B = product_transposed(G[0], G[0]);
  for (int i = 1; i < kCorners; ++i) {
    const Mat<N> one = product_transposed(G[i], G[i]);
    for (int k = 0; k < 9; ++k) B.m[k / 3][k % 3] += one.m[k / 3][k % 3];
  }
  B = scaled(N(1.0 / kCorners), B);
  const N none(0.0), L00 = sqrt(B(0, 0)), L10 = B(1, 0) / L00, L20 = B(2, 0) / L00;
  const N L11 = sqrt(B(1, 1) - L10 * L10), L21 = (B(2, 1) - L20 * L10) / L11;
  return {{{L00, none, none}, {L10, L11, none}, {L20, L21, sqrt(B(2, 2) - L20 * L20 - L21 * L21)}}};
}

/// Rows of length 1.
template <class N>
HEXAPLAST_INLINE Mat<N> unit_rows(const Mat<N>& A) {
  Mat<N> rows;
  for (int n = 0; n < 3; ++n) {
    const N scale = N(1.0) / sqrt(dot(A.m[n], A.m[n]));
    for (int k = 0; k < 3; ++k) rows(n, k) = scale * A(n, k);
  }
  return rows;
}

/// Rows n_n = G^T J^n / |G^T J^n|; J_inverse: rows J^n, of any length.                                         eq. P6
template <class N>
HEXAPLAST_INLINE Mat<N> face_normals(const Mat<N>& G, const Mat<N>& J_inverse) {
  return unit_rows(J_inverse * G);
}

/// sym(S sigma) / beta + p: true stress in the rotated frame. sigma: the corotated stress without p, the pressure of
/// the volume ratio beta.                                                                                     eq. P7t
template <class N>
HEXAPLAST_INLINE Sym<N> cauchy_stress(const Sym<N>& S, const Sym<N>& sigma, N p, N beta) {
  const Sym<N> product = symmetric_part(scaled(N(1.0) / beta, matrix(S) * matrix(sigma)));
  return {product.xx + p, product.yy + p, product.zz + p, product.yz, product.zx, product.xy};
}

/// A_i <- A_i - sum_n s_in c_n n_in n_in^T,  c_n = (1/8) sum_j s_jn n_jn . A_j n_jn: without what of the normal
/// components is linear in s, which a hexahedron cannot show. normals: rows n_in.                         eq. P8, P11
template <class N>
HEXAPLAST_INLINE void relieve(const Mat<N> (&normals)[kCorners], Sym<N> (&A)[kCorners]) {
  N c[3] = {N(0.0), N(0.0), N(0.0)};
  for (int j = 0; j < kCorners; ++j) {
    const Mat<N> all = product_transposed(normals[j] * matrix(A[j]), normals[j]);
    for (int n = 0; n < 3; ++n) c[n] += N(kCornerSign[j][n] / 8.0) * all(n, n);
  }
  for (int i = 0; i < kCorners; ++i)
    for (int n = 0; n < 3; ++n) {
      const N scale = N(kCornerSign[i][n]) * c[n];
      const N x = normals[i](n, 0), y = normals[i](n, 1), z = normals[i](n, 2);
      A[i].xx -= scale * x * x;
      A[i].yy -= scale * y * y;
      A[i].zz -= scale * z * z;
      A[i].yz -= scale * y * z;
      A[i].zx -= scale * z * x;
      A[i].xy -= scale * x * y;
    }
}

/// gamma = min(rate dt, 1) max(0, 1 - threshold / norm).                                                       eq. P9
template <class N>
HEXAPLAST_INLINE N isolated_flow_fraction(N norm, N threshold, N rate_dt) {
  // select: no stress above no threshold is no flow
  return select(norm > threshold, min(rate_dt, N(1.0)) * (N(1.0) - threshold / norm), N(0.0));
}

/// fraction dev( log S + (relieved - sigma) / (2 mu) ); log: dev log S.                                       eq. P10
template <class N>
HEXAPLAST_INLINE Sym<N> flow_direction(const Sym<N>& log, const Sym<N>& relieved, const Sym<N>& sigma, N mu,
                                       N fraction) {
  const N scale = N(0.5) / mu;
  const N xx = log.xx + scale * (relieved.xx - sigma.xx), yy = log.yy + scale * (relieved.yy - sigma.yy),
          zz = log.zz + scale * (relieved.zz - sigma.zz), mean = N(1.0 / 3) * (xx + yy + zz);
  return {fraction * (xx - mean),
          fraction * (yy - mean),
          fraction * (zz - mean),
          fraction * (log.yz + scale * (relieved.yz - sigma.yz)),
          fraction * (log.zx + scale * (relieved.zx - sigma.zx)),
          fraction * (log.xy + scale * (relieved.xy - sigma.xy))};
}

/// exp(A) - 1 of a symmetric matrix by this many terms of its series, whose powers the characteristic equation reduces
/// to three numbers.
template <class N>
HEXAPLAST_INLINE Mat<N> exponential_series(const Mat<N>& A, int terms) {
  const Mat<N> AA = A * A, cof = cofactor(A);
  const N i1 = A(0, 0) + A(1, 1) + A(2, 2), i2 = cof(0, 0) + cof(1, 1) + cof(2, 2), i3 = dot(A.m[0], cof.m[0]);
  N a(1.0), b(0.0), c(0.0);  // Horner: A (1 + A / 2 (1 + A / 3 (...)))
  for (int k = terms; k >= 2; --k) {
    const N scale(ScalarOf<N>(1.0 / k)), above = c;
    c = scale * (b + i1 * above);
    b = scale * (a - i2 * above);
    a = N(1.0) + scale * i3 * above;
  }
  const N above = c;
  c = b + i1 * above;
  b = a - i2 * above;
  a = i3 * above;
  Mat<N> E;
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s) E(r, s) = (r == s ? a : N(0.0)) + b * A(r, s) + c * AA(r, s);
  return E;
}

/// exp(M) - 1, to rounding for |M| up to 8: the series of M / 4, squared twice.
template <class N>
HEXAPLAST_INLINE Mat<N> symmetric_expm1(const Sym<N>& M) {
  Mat<N> E = exponential_series(scaled(N(0.25), matrix(M)), 24);
  for (int squaring = 0; squaring < 2; ++squaring) {  // (1 + E)^2 - 1
    const Mat<N> EE = E * E;
    for (int k = 0; k < 9; ++k) E.m[k / 3][k % 3] = N(2.0) * E.m[k / 3][k % 3] + EE.m[k / 3][k % 3];
  }
  return E;
}

/// G exp(-M).                                                                                                 eq. P12
template <class N>
HEXAPLAST_INLINE Mat<N> flowed_plastic_inverse(const Mat<N>& G, const Sym<N>& M) {
  const Mat<N> change = G * symmetric_expm1(Sym<N>{-M.xx, -M.yy, -M.zz, -M.yz, -M.zx, -M.xy});
  Mat<N> flowed;
  for (int k = 0; k < 9; ++k) flowed.m[k / 3][k % 3] = G.m[k / 3][k % 3] + change.m[k / 3][k % 3];
  return flowed;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
