// SPDX-License-Identifier: LGPL-2.1-or-later
// Elements in lanes: which they are, their isolated rest shapes, and what of these flows.
#if defined(HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL
#undef HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL
#else
#define HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL
#endif

#include "base/corner_tensors.hpp"
#include "base/transpose-inl.hpp"
#include "element/element-inl.hpp"
#include "element/isolated-inl.hpp"
#include "layout/partition.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// The elements of one register; in the place of those that are not there the first one of the block.
template <class V>
struct LaneElements {
  LaneElements(const Partition& partition, int block, int lane) {
    for (int k = 0; k < V::kCount; ++k) {
      const int e = partition.element(block, lane + k);
      number[k] = e < 0 ? partition.element(block, 0) : e;
    }
  }
  int number[V::kCount];
};

/// Of numbers of G, sample by sample and column by column.
template <class Numbers>
HWY_INLINE void set_plastic_inverse(const Numbers& numbers, PlasticLanes<Lanes<double>>& plastic) {
  for (int i = 0; i < kCorners; ++i)
    for (int k = 0; k < 9; ++k) plastic.inverse[i](k % 3, k / 3) = numbers(9 * i + k);
  assign(mean_plastic_inverse(plastic.inverse), plastic.mean);
}

/// A bit per element some corner of which has a ratio d below `from`.                                       eq. E22
template <bool kGeneral, class V>
HWY_NOINLINE std::uint32_t find_thin(const CornerLanes<V>& x, const CornerLanes<V>& u, V volume, double from) {
  EdgeLanes<V> now;
  edges(u, now);
  V lowest(ScalarOf<V>(1e30));
  if constexpr (kGeneral) {
    EdgeLanes<V> before;
    edges(x, before);
    V of_rest[kCorners], largest(ScalarOf<V>(0));
    for (int i = 0; i < kCorners; ++i) {
      of_rest[i] = determinant(edges_at(before, i));
      largest = max(largest, of_rest[i]);
    }
    for (int i = 0; i < kCorners; ++i)
      lowest = min(lowest, V(1.0) + (determinant(edges_at(now, i)) - of_rest[i]) / max(of_rest[i], V(0.1) * largest));
  } else {
    for (int i = 0; i < kCorners; ++i) lowest = min(lowest, determinant(edges_at(now, i)) / volume);
  }
  return bits<ScalarOf<V>>(hn::Not(lowest > V(from)));
}

/// [Pa] The stress that yields at the samples of isolated rest shapes, and the directions in which an element cannot
/// show all of it: relieve(normals, sigma) takes that away. corotated: without the pressure of the volume ratio.
///                                                                                                 eq. P6, P7, P7t
template <bool kGeneral, class N>
HWY_INLINE void yielding_stress(const ElementLanes<kGeneral, Assumed::kCorner, N>& element, const MaterialLanes<N>& of,
                                const PressureLanes<N>& p, YieldStressMeasure measure, Mat<N> (&normals)[kCorners],
                                Sym<N> (&corotated)[kCorners], Sym<N> (&sigma)[kCorners]) {
  using T = ScalarOf<N>;
  const N pressure = p.in_stress - p.shared;
  for (int i = 0; i < kCorners; ++i) {
    const Sym<N>& S = element.polar[i].S;
    corotated[i] = stress(of.law, of.mooney_fraction, S, of.mu, p.at(dilatation(of.law, S)));
    sigma[i] = corotated[i];
    if (measure == YieldStressMeasure::kCauchy) {
      sigma[i] = cauchy_stress(S, corotated[i], pressure, N(T(1)) + p.excess);
    } else {
      sigma[i].xx += pressure;
      sigma[i].yy += pressure;
      sigma[i].zz += pressure;
    }
    if (element.plastic)
      normals[i] = face_normals(element.plastic->inverse[i], dual_of(element.rest));
    else if (i == 0)
      normals[i] = unit_rows(dual_of(element.rest));
    else
      normals[i] = normals[0];
  }
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
