// SPDX-License-Identifier: LGPL-2.1-or-later
// Elements in lanes: which they are, their isolated rest shapes, what of these flows, and their viscoelastic branches.
#if defined(HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL
#undef HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL
#else
#define HEXAPLAST_ELEMENT_LANE_ELEMENTS_INL
#endif

#include <span>

#include "base/tensors-inl.hpp"
#include "base/transpose-inl.hpp"
#include "element/element-inl.hpp"
#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "layout/corners-inl.hpp"
#include "layout/partition.hpp"
#include "material/relaxation.hpp"

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

/// What the elements of one register are made of. lame_blocks: [Pa] mu and lambda of each block.
template <class T>
HEXAPLAST_INLINE MaterialLanes<Lanes<T>> material_lanes(const Settings& settings, std::span<const double> lame_blocks,
                                                        int block, int lane) {
  const double* lame = lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  return {settings, load_narrow<T>(lame), load_narrow<T>(lame + kBlock)};
}

/// Of numbers of G, sample by sample and column by column.
template <class Numbers>
HEXAPLAST_INLINE void set_plastic_inverse(const Numbers& numbers, PlasticLanes<Lanes<double>>& plastic) {
  for (int i = 0; i < kCorners; ++i)
    for (int k = 0; k < 9; ++k) plastic.inverse[i](k % 3, k / 3) = numbers(9 * i + k);
  assign(mean_plastic_inverse(plastic.inverse), plastic.mean);
}

/// A bit per element some corner of which has a ratio d below `from`.                                       eq. E22
template <bool kGeneral, class V>
HEXAPLAST_NOINLINE std::uint32_t find_thin(const CornerLanes<V>& x, const CornerLanes<V>& u, V volume, double from) {
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
  return bits<ScalarOf<V>>(not_of(lowest > V(from)));
}

/// The directions in which an element cannot show all of the stress of its samples: relieve(normals, sigma) takes that
/// away.                                                                                                       eq. P6
template <bool kGeneral, class N>
HEXAPLAST_INLINE void sample_normals(const ElementLanes<kGeneral, N>& element, Mat<N> (&normals)[kCorners]) {
  normals[0] = unit_rows(dual_of(element.rest));
  for (int i = 0; i < kCorners; ++i)
    if (element.plastic)
      normals[i] = face_normals(element.plastic->inverse[i], dual_of(element.rest));
    else
      normals[i] = normals[0];
}

/// [Pa] The stress that yields at the samples of isolated rest shapes. corotated: without the pressure of the volume
/// ratio. of_branches: s, or null.                                                                      eq. P7, P7t
template <bool kGeneral, class N>
HEXAPLAST_INLINE void yielding_stress(const ElementLanes<kGeneral, N>& element, const MaterialLanes<N>& of,
                                      const PressureLanes<N>& p, YieldStressMeasure measure,
                                      const std::type_identity_t<Sym<N>>* of_branches, Sym<N> (&corotated)[kCorners],
                                      Sym<N> (&sigma)[kCorners]) {
  using T = ScalarOf<N>;
  const N pressure = p.in_stress - p.shared;
  for (int i = 0; i < kCorners; ++i) {
    const Sym<N>& S = element.polar[i].S;
    corotated[i] = stress(of.law, of.mooney_fraction, S, of.mu, p.at(dilatation(of.law, S)));
    if (of_branches) corotated[i] = sum(corotated[i], N(T(1)), of_branches[i]);
    sigma[i] = corotated[i];
    if (measure == YieldStressMeasure::kCauchy) {
      sigma[i] = cauchy_stress(S, corotated[i], pressure, N(T(1)) + p.excess);
    } else {
      sigma[i].xx += pressure;
      sigma[i].yy += pressure;
      sigma[i].zz += pressure;
    }
  }
}

/// A symmetric tensor per sample, one element per lane.
template <class Address>
HEXAPLAST_INLINE void load_tensors(const int* elements, const Address& address, Sym<Lanes<double>> (&to)[kCorners]) {
  Lanes<double> n[6 * kCorners];
  load_elements<6 * kCorners>(addresses<const double>(elements, address), n);
  for (int i = 0; i < kCorners; ++i)
    to[i] = {n[6 * i], n[6 * i + 1], n[6 * i + 2], n[6 * i + 3], n[6 * i + 4], n[6 * i + 5]};
}
template <class Address>
HEXAPLAST_INLINE void store_tensors(const Sym<Lanes<double>> (&from)[kCorners], const int* elements,
                                    std::uint32_t wanted, const Address& address) {
  Lanes<double> n[6 * kCorners];
  for (int i = 0; i < kCorners; ++i) {
    const Sym<Lanes<double>>& S = from[i];
    n[6 * i] = S.xx, n[6 * i + 1] = S.yy, n[6 * i + 2] = S.zz;
    n[6 * i + 3] = S.yz, n[6 * i + 4] = S.zx, n[6 * i + 5] = S.xy;
  }
  store_elements<6 * kCorners>(n, wanted, addresses<double>(elements, address));
}

/// Of these elements. Null: nothing relaxes.
template <class V>
HEXAPLAST_NOINLINE const BranchLanes<V>* load_branches(const int* elements, const Branches& branches, V mu, V lambda,
                                                       BranchLanes<V>& to) {
  if (!branches.any()) return nullptr;
  set_branches(
      branches, mu, lambda, [&](const auto& address, Sym<V>(&B)[kCorners]) { load_tensors(elements, address, B); }, to);
  return &to;
}
template <class V>
HEXAPLAST_INLINE const BranchLanes<V>* load_branches(const Partition& partition, const Branches& branches, int block,
                                                     int lane, V mu, V lambda, BranchLanes<V>& to) {
  if (!branches.any()) return nullptr;
  return load_branches(LaneElements<V>(partition, block, lane).number, branches, mu, lambda, to);
}

template <class V>
HEXAPLAST_NOINLINE Mat<V> balance_by_axes(const Sym<V>& q, const Sym<V>& S) {
  return bounded_balance(q, S);
}

/// q + A at a sample. V: lanes of double.                                                                eq. P14, P15
template <class V>
HEXAPLAST_INLINE Mat<V> balanced_stress(const Sym<V>& q, const PolarLanes<V>& polar) {
  const std::uint32_t bounded = polar.doubtful | bits<double>(not_of(determinant(polar.S) > V(0.0)));
  Mat<V> balanced = in_balance(q, polar.S);
  if (bounded != 0) [[unlikely]]
    balanced = select_bits(bounded, balance_by_axes(q, polar.S), balanced);
  return balanced;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
