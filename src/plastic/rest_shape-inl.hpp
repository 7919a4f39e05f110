// SPDX-License-Identifier: LGPL-2.1-or-later
// Volume restitution, for elements in lanes and for one element.
#if defined(HEXAPLAST_PLASTIC_REST_SHAPE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_PLASTIC_REST_SHAPE_INL
#undef HEXAPLAST_PLASTIC_REST_SHAPE_INL
#else
#define HEXAPLAST_PLASTIC_REST_SHAPE_INL
#endif

#include "base/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

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
