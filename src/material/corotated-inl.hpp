// SPDX-License-Identifier: LGPL-2.1-or-later
// The law of corotated.hpp, for samples in lanes and for one sample.
#if defined(HEXAPLAST_MATERIAL_COROTATED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_MATERIAL_COROTATED_INL
#undef HEXAPLAST_MATERIAL_COROTATED_INL
#else
#define HEXAPLAST_MATERIAL_COROTATED_INL
#endif

#include "base/tensors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// mu |S - I|^2 + lambda / 2 tr(S - I)^2.                                                                   eq. 11
template <class N>
HWY_INLINE N energy_density(const Sym<N>& S, N mu, N lambda) {
  const N one(1.0), xx = S.xx - one, yy = S.yy - one, zz = S.zz - one, trace = xx + yy + zz;
  const N squared = xx * xx + yy * yy + zz * zz + N(2.0) * (S.yz * S.yz + S.zx * S.zx + S.xy * S.xy);
  return mu * squared + N(0.5) * lambda * trace * trace;
}

/// sigma = 2 mu (S - I) + lambda tr(S - I) I.                                                               eq. 12
template <class N>
HWY_INLINE Sym<N> stress(const Sym<N>& S, N mu, N lambda) {
  const N twice = mu + mu, one(1.0), three(3.0);
  const N pressure = lambda * (S.xx + S.yy + S.zz - three);
  return {twice * (S.xx - one) + pressure,
          twice * (S.yy - one) + pressure,
          twice * (S.zz - one) + pressure,
          twice * S.yz,
          twice * S.zx,
          twice * S.xy};
}

/// 2 mu sym Z + lambda tr(Z) I: of Z = R^T dF it is R^T dP (eq. 14), of Z = dF R^T it is dP R^T (eq. 52).
template <class N>
HWY_INLINE Mat<N> stress_increment(const Mat<N>& Z, N mu, N lambda) {
  const N trace = lambda * (Z(0, 0) + Z(1, 1) + Z(2, 2)), twice = mu + mu;
  Mat<N> P;
  for (int r = 0; r < 3; ++r) {
    P(r, r) = twice * Z(r, r) + trace;
    for (int c = 0; c < r; ++c) P(r, c) = P(c, r) = mu * (Z(r, c) + Z(c, r));
  }
  return P;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
