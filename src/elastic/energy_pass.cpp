// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/energy_pass.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/body_elements-inl.hpp"
#include "elastic/energy_pass.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Elastic energy.                                                                              eq. 18, E5, E14, P17
double energy_of(const Model& model, const CornerTensors* plastic_inverse, const Branches& branches,
                 const double* plastic_rest, const double* current, std::uint16_t present, int block,
                 std::uint16_t* thin) {
  using V = Lanes<double>;
  V sum(0.0);
  *thin = 0;
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    const std::uint32_t here = static_cast<std::uint32_t>(present) >> lane;
    CornerLanes<V> x, u;
    ModeLanes<V> gradient;
    gather_shapes(*model.partition, block, lane, here, plastic_rest, current, x, u);
    const MaterialLanes<V> of = material_of(model, block, lane);
    PlasticLanes<V> of_lanes;
    const PlasticLanes<V>* const plastic = load_plastic(*model.partition, plastic_inverse, block, lane, of_lanes);
    if (const double from = Recovery::from(model.settings); std::isfinite(from))
      *thin |= find_thin<true>(x, u, V(0.0), from) << lane;
    ElementLanes<true, V> element;
    place_element(x, u, sampling_of(model.settings), plastic, element);
    decompose(element);
    V density = mean_energy_density(of, element, pressures(of, element, u, gradient));
    BranchLanes<V> lanes;
    if (const BranchLanes<V>* held = load_branches(*model.partition, branches, block, lane, of.mu, of.lambda, lanes)) {
      Sym<V> D[kCorners];
      held->changes([&](int i) { return element.polar[i].S; }, D);
      for (int i = 0; i < kCorners; ++i) density += V(1.0 / kCorners) * held->energy(i, D[i]);
    }
    sum += select_bits(here, element.rest.volume * density, V(0.0));
  }
  return hn::GetLane(hn::SumOfLanes(V::Tag(), sum.raw()));
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(energy_of);

double block_energy(const Model& model, const CornerTensors* plastic_inverse, const Branches& branches,
                    const double* plastic_rest, const double* current, std::uint16_t present, int block,
                    std::uint16_t* thin) {
  return HWY_DYNAMIC_DISPATCH(energy_of)(model, plastic_inverse, branches, plastic_rest, current, present, block, thin);
}

}  // namespace hexaplast
#endif
