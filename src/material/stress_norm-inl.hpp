// SPDX-License-Identifier: LGPL-2.1-or-later
// Size of a stress, for samples in lanes and for one sample.
#if defined(HEXAPLAST_MATERIAL_STRESS_NORM_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_MATERIAL_STRESS_NORM_INL
#undef HEXAPLAST_MATERIAL_STRESS_NORM_INL
#else
#define HEXAPLAST_MATERIAL_STRESS_NORM_INL
#endif

#include "base/lanes-inl.hpp"
#include "base/matrix-inl.hpp"
#include "hexaplast/material/material.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// The stress norm of the yield condition; of the spectral norm, which takes eigenvalues, an upper bound.       eq. 20
template <class N>
HEXAPLAST_INLINE N stress_norm_bound(const Sym<N>& s, YieldNorm norm) {
  const N mean = norm == YieldNorm::kVonMises ? N(1.0 / 3) * (s.xx + s.yy + s.zz) : N(0.0);
  const N xx = s.xx - mean, yy = s.yy - mean, zz = s.zz - mean;
  const N squared = xx * xx + yy * yy + zz * zz + N(2.0) * (s.yz * s.yz + s.zx * s.zx + s.xy * s.xy);
  return sqrt(norm == YieldNorm::kVonMises ? N(1.5) * squared : squared);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
