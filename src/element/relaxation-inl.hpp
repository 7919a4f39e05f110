// SPDX-License-Identifier: LGPL-2.1-or-later
// Viscoelastic branches, of which each sample of a hexahedron has strains of its own. For samples in lanes and for one
// sample, without lanes or matrices of other libraries.                                         theory.md section 5.10
#if defined(HEXAPLAST_ELEMENT_RELAXATION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELEMENT_RELAXATION_INL
#undef HEXAPLAST_ELEMENT_RELAXATION_INL
#else
#define HEXAPLAST_ELEMENT_RELAXATION_INL
#endif

#include <array>

#include "base/matrix-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// S - tr(S) / 3.
template <class N>
HWY_INLINE Sym<N> deviator(const Sym<N>& S) {
  const N mean = N(1.0 / 3) * (S.xx + S.yy + S.zz);
  return {S.xx - mean, S.yy - mean, S.zz - mean, S.yz, S.zx, S.xy};
}

/// A + factor B.
template <class N>
HWY_INLINE Sym<N> sum(const Sym<N>& A, N factor, const Sym<N>& B) {
  return {A.xx + factor * B.xx, A.yy + factor * B.yy, A.zz + factor * B.zz,
          A.yz + factor * B.yz, A.zx + factor * B.zx, A.xy + factor * B.xy};
}

/// A : B.
template <class N>
HWY_INLINE N product(const Sym<N>& A, const Sym<N>& B) {
  return A.xx * B.xx + A.yy * B.yy + A.zz * B.zz + N(2.0) * (A.yz * B.yz + A.zx * B.zx + A.xy * B.xy);
}

/// b after a step in which the deviator of the stretch changes by D.                                          eq. P13
template <class N>
HWY_INLINE Sym<N> branch_strain(N decay, const Sym<N>& b, N response, const Sym<N>& D) {
  return sum(Sym<N>{decay * b.xx, decay * b.yy, decay * b.zz, decay * b.yz, decay * b.zx, decay * b.xy}, response, D);
}

/// q + A, with which q's moments are in balance, where no stretches are opposite.                             eq. P15
///
///   A = [w]x,  (tr S - S) w = v,  [v]x = S q - q S
template <class N>
HWY_INLINE Mat<N> in_balance(const Sym<N>& q, const Sym<N>& S) {
  const Mat<N> Sq = matrix(S) * matrix(q);
  const N v[3] = {Sq(2, 1) - Sq(1, 2), Sq(0, 2) - Sq(2, 0), Sq(1, 0) - Sq(0, 1)};
  const N trace = S.xx + S.yy + S.zz;
  const Mat<N> K = matrix(Sym<N>{trace - S.xx, trace - S.yy, trace - S.zz, -S.yz, -S.zx, -S.xy}), cof = cofactor(K);
  const N inverse = N(1.0) / dot(K.m[0], cof.m[0]);
  N w[3];
  for (int k = 0; k < 3; ++k) w[k] = inverse * dot(cof.m[k], v);
  return {{{q.xx, q.xy - w[2], q.zx + w[1]}, {q.xy + w[2], q.yy, q.yz - w[0]}, {q.zx - w[1], q.yz + w[0], q.zz}}};
}

HWY_INLINE Sym<double> symmetric(const std::array<double, 6>& n) { return {n[0], n[1], n[2], n[3], n[4], n[5]}; }
HWY_INLINE std::array<double, 6> numbers(const Sym<double>& S) { return {S.xx, S.yy, S.zz, S.yz, S.zx, S.xy}; }

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
