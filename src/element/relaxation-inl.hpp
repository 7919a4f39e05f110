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
#include "hexaplast/base/corners.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

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

/// (lambda_f' - lambda_f) / (2 mu): what branches, of which the g have this sum, add to the modulus of a sample's own
/// dilatation where nothing has relaxed. Not below -g / 3, where they resist it no more. Moduli of either sign.
///                                                                                                      eq. E2, P14
template <class N>
HWY_INLINE N branch_free_modulus(N mu, N lambda, N g) {
  using T = ScalarOf<N>;
  const N tiny(T(1e-30)), one(T(1)), two(T(2)), all = one + g, fourths = two + N(T(4.0 / 3)) * g;
  const N slow = abs(lambda) / max(abs(lambda + two * mu), tiny),
          sudden = one - two * all * (abs(mu) / max(abs(lambda + fourths * mu), tiny));
  return max(all * sudden - slow, N(T(-1.0 / 3)) * g);
}

/// c, the weight of a sample's own dilatation in what branches act on.                                       eq. P13
template <class N>
HWY_INLINE N dilatation_weight(N mu, N lambda, N g) {
  const N third = N(1.0 / 3) * g;
  return sqrt(max((branch_free_modulus(mu, lambda, g) + third) / (g + g + g), N(0.0)));
}

/// What branches act on: B_i = dev S_i + c (tr S_i - mean tr S) 1. stretch(i): S_i.                         eq. P13
template <class N, class Stretch>
HWY_INLINE void branch_stretches(N c, const Stretch& stretch, Sym<N> (&B)[kCorners]) {
  N trace[kCorners], mean(0.0);
  for (int i = 0; i < kCorners; ++i) {
    const Sym<N> S = stretch(i);
    trace[i] = S.xx + S.yy + S.zz;
    mean += N(1.0 / kCorners) * trace[i];
  }
  for (int i = 0; i < kCorners; ++i) {
    const N own = c * (trace[i] - mean) - N(1.0 / 3) * trace[i];
    B[i] = stretch(i);
    B[i].xx += own;
    B[i].yy += own;
    B[i].zz += own;
  }
}

/// dev q + c tr(q) 1: the stress that does on S_i the work of q on B_i, because the tr q of the samples have no mean.
template <class N>
HWY_INLINE Sym<N> branch_stress(N c, const Sym<N>& q) {
  const N own = (c - N(1.0 / 3)) * (q.xx + q.yy + q.zz);
  return {q.xx + own, q.yy + own, q.zz + own, q.yz, q.zx, q.xy};
}

/// b after a step in which B changes by D.                                                                  eq. P13
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
