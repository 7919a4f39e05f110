// SPDX-License-Identifier: LGPL-2.1-or-later
// The law of corotated.hpp, one sample per SIMD lane.
#if defined(HEXAPLAST_MATERIAL_COROTATED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_MATERIAL_COROTATED_INL
#undef HEXAPLAST_MATERIAL_COROTATED_INL
#else
#define HEXAPLAST_MATERIAL_COROTATED_INL
#endif

#include "base/lanes-inl.hpp"
#include "hexaplast/material/material.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// mu |S - I|^2 + lambda / 2 tr(S - I)^2.                                                                   eq. 11
template <class V>
HWY_INLINE V energy_density(const Sym<V>& S, V mu, V lambda) {
  const V one(1.0), xx = S.xx - one, yy = S.yy - one, zz = S.zz - one, trace = xx + yy + zz;
  const V squared = xx * xx + yy * yy + zz * zz + V(2.0) * (S.yz * S.yz + S.zx * S.zx + S.xy * S.xy);
  return mu * squared + V(0.5) * lambda * trace * trace;
}

/// sigma = 2 mu (S - I) + lambda tr(S - I) I.                                                               eq. 12
template <class V>
HWY_INLINE Sym<V> stress(const Sym<V>& S, V mu, V lambda) {
  const V twice = mu + mu, one(1.0), three(3.0);
  const V pressure = lambda * (S.xx + S.yy + S.zz - three);
  return {twice * (S.xx - one) + pressure,
          twice * (S.yy - one) + pressure,
          twice * (S.zz - one) + pressure,
          twice * S.yz,
          twice * S.zx,
          twice * S.xy};
}

/// The stress norm of the yield condition; of the spectral norm an upper bound.
template <class V>
HWY_INLINE V stress_norm_bound(const Sym<V>& s, YieldNorm norm) {
  const V mean = norm == YieldNorm::kVonMises ? V(1.0 / 3) * (s.xx + s.yy + s.zz) : V(0.0);
  const V xx = s.xx - mean, yy = s.yy - mean, zz = s.zz - mean;
  const V squared = xx * xx + yy * yy + zz * zz + V(2.0) * (s.yz * s.yz + s.zx * s.zx + s.xy * s.xy);
  return sqrt(norm == YieldNorm::kVonMises ? V(1.5) * squared : squared);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
