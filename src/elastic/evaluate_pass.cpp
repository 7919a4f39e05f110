// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/evaluate_pass.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/body_elements-inl.hpp"
#include "elastic/evaluate_pass.hpp"
#include "material/law-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

using V = Lanes<double>;

/// One register of elements.
struct EvaluatedLanes {
  EvaluatedLanes(const EvaluatedBlock& at, int lane)
      : present(static_cast<std::uint32_t>(at.present) >> lane),
        of(material_lanes<double>(at.model.settings, at.model.lame_blocks, at.block, lane)) {
    const Partition& partition = *at.model.partition;
    gather_shapes(partition, at.block, lane, present, at.plastic_rest, at.current, x, u);
    place_element(x, u, sampling_of(at.model.settings),
                  load_plastic(partition, at.plastic_inverse, at.block, lane, plastic), element);
    decompose(element);
    ModeLanes<V> gradient;
    pressure = pressures(of, element, u, gradient);
    branches = load_branches(partition, at.branches, at.block, lane, of.mu, of.lambda, held);
    if (branches) branches->changes([&](int i) { return element.polar[i].S; }, changes);
  }
  EvaluatedLanes(const EvaluatedLanes&) = delete;

  std::uint32_t present;
  MaterialLanes<V> of;
  CornerLanes<V> x, u;
  PlasticLanes<V> plastic;
  ElementLanes<true, V> element;
  PressureLanes<V> pressure;
  const BranchLanes<V>* branches;  ///< null: nothing relaxes
  Sym<V> changes[kCorners];        ///< D of the branches

 private:
  BranchLanes<V> held;
};

/// Elastic energy.                                                                              eq. 18, E5, E14, P17
double energy_of(const EvaluatedBlock& at, std::uint16_t* thin) {
  V sum(0.0);
  *thin = 0;
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    const EvaluatedLanes here(at, lane);
    if (const double from = Recovery::from(at.model.settings); std::isfinite(from))
      *thin |= find_thin<true>(here.x, here.u, V(0.0), from) << lane;
    V density = mean_energy_density(here.of, here.element, here.pressure);
    for (int i = 0; i < kCorners && here.branches; ++i)
      density += V(1.0 / kCorners) * here.branches->energy(i, here.changes[i]);
    sum += select_bits(here.present, here.element.rest.volume * density, V(0.0));
  }
  return hn::GetLane(hn::SumOfLanes(V::Tag(), sum.raw()));
}

/// max_k |lambda_k - from| of the eigenvalues, which the stretch of a rotation's mirror image has of both signs.
HEXAPLAST_NOINLINE V largest_deviation(const Sym<V>& A, V from) {
  const SvdOf<V> svd = signed_svd(matrix(A));
  return max(max(abs(svd.d[0] - from), abs(svd.d[1] - from)), abs(svd.d[2] - from));
}

void fields_of(const EvaluatedBlock& at, bool yields, const EvaluatedFields& fields) {
  const Settings& settings = at.model.settings;
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    const EvaluatedLanes here(at, lane);
    const MaterialLanes<V>& of = here.of;
    Sym<V> sigma[kCorners], of_branches[kCorners];
    for (int i = 0; i < kCorners && here.branches; ++i) of_branches[i] = here.branches->stress(i, here.changes[i]);
    if (yields) {
      Sym<V> corotated[kCorners];
      Mat<V> normals[kCorners];
      yielding_stress(here.element, of, here.pressure, settings.yield_stress_measure,
                      here.branches ? of_branches : nullptr, corotated, sigma);
      sample_normals(here.element, normals);
      relieve(normals, sigma);
    } else {
      for (int i = 0; i < kCorners; ++i) {
        const Sym<V>& S = here.element.polar[i].S;
        sigma[i] = stress(of.law, of.mooney_fraction, S, of.mu, here.pressure.in_stress_at(dilatation(of.law, S)));
        if (here.branches) sigma[i] = sum(sigma[i], V(1.0), of_branches[i]);
      }
    }
    V norm(0.0), strain(0.0);
    for (int i = 0; i < kCorners; ++i) {
      norm = max(norm, settings.yield_norm == YieldNorm::kSpectral ? largest_deviation(sigma[i], V(0.0))
                                                                   : stress_norm_bound(sigma[i], settings.yield_norm));
      strain = max(strain, largest_deviation(here.element.polar[i].S, V(1.0)));
    }
    alignas(64) double norms[V::kCount], strains[V::kCount], volumes[V::kCount];
    store(norm, norms);
    store(strain, strains);
    store(here.element.rest.volume, volumes);
    for (int k = 0; k < V::kCount; ++k) {
      if (!(here.present >> k & 1)) continue;
      const int e = at.model.partition->element(at.block, lane + k);
      fields.stress_norm[e] = norms[k];
      fields.strain[e] = strains[k];
      fields.volume_ratio[e] = volumes[k] / at.model.volume[e];
    }
  }
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(energy_of);
HWY_EXPORT(fields_of);

double block_energy(const EvaluatedBlock& at, std::uint16_t* thin) { return HWY_DYNAMIC_DISPATCH(energy_of)(at, thin); }
void block_fields(const EvaluatedBlock& at, bool yields, const EvaluatedFields& fields) {
  HWY_DYNAMIC_DISPATCH(fields_of)(at, yields, fields);
}

}  // namespace hexaplast
#endif
