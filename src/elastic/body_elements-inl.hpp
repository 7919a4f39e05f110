// SPDX-License-Identifier: LGPL-2.1-or-later
// Elements of a body in lanes: their corners and their isolated rest shapes.
#if defined(HEXAPLAST_ELASTIC_BODY_ELEMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELASTIC_BODY_ELEMENTS_INL
#undef HEXAPLAST_ELASTIC_BODY_ELEMENTS_INL
#else
#define HEXAPLAST_ELASTIC_BODY_ELEMENTS_INL
#endif

#include "element/lane_elements-inl.hpp"
#include "state/linearization.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// The G of a register of elements, of those of all elements, into `plastic`; null: nothing has flowed.
template <class V>
HEXAPLAST_NOINLINE const PlasticLanes<V>* load_plastic(const Partition& partition, const CornerTensors* plastic_inverse,
                                                       int block, int lane, PlasticLanes<V>& plastic) {
  if (!plastic_inverse) return nullptr;
  const LaneElements<V> elements(partition, block, lane);
  V numbers[9 * kCorners];
  load_elements<9 * kCorners>(
      addresses<const double>(elements.number, [&](int e) { return plastic_inverse[e][0].data(); }), numbers);
  set_plastic_inverse([&](int n) { return numbers[n]; }, plastic);
  return &plastic;
}

/// Loads an element per lane; those that are not there become unit cubes.
template <class V>
HEXAPLAST_INLINE void gather_shapes(const Partition& partition, int block, int lane, std::uint32_t present,
                                    const double* plastic_rest, const double* current, CornerLanes<V>& x,
                                    CornerLanes<V>& u) {
  gather(partition, block, lane, plastic_rest, x);
  gather(partition, block, lane, current, u);
  replace_absent(present, x);
  replace_absent(present, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
