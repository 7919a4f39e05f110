// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the function at the end chooses at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "plastic/flow_pass.cpp"
#include "hwy/foreach_target.h"
//
#include <algorithm>
#include <cmath>
#include <limits>

#include "element/lane_elements-inl.hpp"
#include "material/law-inl.hpp"
#include "plastic/flow_pass.hpp"
#include "plastic/point_flow-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

using D = Lanes<double>;

/// kNumbers of each element from a history, in double precision, and rounded to T.
template <class T, int kNumbers>
struct HistoryLanes {
  HistoryLanes() = default;
  template <class Address>
  HEXAPLAST_INLINE HistoryLanes(const int* elements, const Address& address) {
    for (int part = 0; part < kParts<T>; ++part) {
      D numbers[kNumbers];
      load_elements<kNumbers>(addresses<const double>(elements + part * D::kCount, address), numbers);
      for (int n = 0; n < kNumbers; ++n) at[n][part] = numbers[n];
    }
  }
  HEXAPLAST_INLINE Lanes<T> operator[](int n) const { return narrow<T>(at[n]); }

  template <class Address>
  HEXAPLAST_INLINE void store(const int* elements, std::uint32_t wanted, const Address& address) const {
    for (int part = 0; part < kParts<T>; ++part) {
      D numbers[kNumbers];
      for (int n = 0; n < kNumbers; ++n) numbers[n] = at[n][part];
      store_elements<kNumbers>(numbers, wanted >> (part * D::kCount),
                               addresses<double>(elements + part * D::kCount, address));
    }
  }

  D at[kNumbers][kParts<T>];
};

/// Corners of the elements of one register at the plastic rest and current positions.
template <class T>
HEXAPLAST_INLINE std::uint32_t gather_elements(const Model& model, const Linearization& at, int block, int lane,
                                               CornerLanes<Lanes<T>>& x, CornerLanes<Lanes<T>>& u) {
  const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
  gather_about_corner<T>(*model.partition, block, lane, at.plastic_rest.data(), x);
  gather_about_corner<T>(*model.partition, block, lane, at.current.data(), u);
  replace_absent(present, x);
  replace_absent(present, u);
  return present;
}

/// A rate of the materials times dt.
template <class T>
HEXAPLAST_INLINE Lanes<T> per_step(const Model& model, const int* elements, double dt, double Material::*rate) {
  if (model.materials.size() == 1) return Lanes<T>(static_cast<T>(dt * model.materials[0].*rate));
  return gather_numbers<T>(elements, [&](int e) { return dt * model.materials[e].*rate; });
}

/// Rotations and stretches of all samples. Returns the elements, a bit each, of which some is not unique.
template <class V>
HEXAPLAST_INLINE std::uint32_t decompose_or_fail(SampleLanes<V>& element) {
  std::uint32_t fails = 0;
  for (int first = 0; first < kCorners; first += kAtOnce) {
    polars<kAtOnce>(element.F + first, element.polar + first);
    for (int m = 0; m < kAtOnce; ++m) fails |= element.polar[first + m].doubtful;
  }
  return fails;
}

/// Thresholds after the step.
template <class T>
HEXAPLAST_INLINE void harden(const Model& model, const int* elements, const Lanes<T>* fractions, const Lanes<T>* sizes,
                             HistoryLanes<T, kCorners>& threshold) {
  for (int part = 0; part < kParts<T>; ++part) {
    const D hardening = gather_numbers(elements + part * D::kCount, [&](int e) { return model.material(e).hardening; });
    for (int i = 0; i < kCorners; ++i)
      threshold.at[i][part] =
          hardened(threshold.at[i][part], hardening, widen(fractions[i], part), widen(sizes[i], part));
  }
}

/// What yields at the samples of one register of elements with isolated rest shapes.
template <class V>
struct IsolatedLanes {
  PlasticLanes<V> plastic;
  Mat<V> normals[kCorners];                     ///< rows n_in
  Sym<V> corotated[kCorners], whole[kCorners];  ///< [Pa] without and with all pressure
  std::uint32_t fails;                          ///< a bit each: samples that are not unique
  Sym<V> of_branches[kCorners];                 ///< [Pa] part of these stresses, where there are branches
};

/// Gm is found in double precision: it has squares of G.
template <class T>
HEXAPLAST_INLINE void narrow_plastic_inverse(const HistoryLanes<T, 9 * kCorners>& numbers,
                                             PlasticLanes<Lanes<T>>& plastic) {
  PlasticLanes<D> parts[kParts<T>];
  for (int part = 0; part < kParts<T>; ++part)
    set_plastic_inverse([&](int n) { return numbers.at[n][part]; }, parts[part]);
  const auto narrowed = [&](const auto& of) __attribute__((always_inline)) {
    Mat<Lanes<T>> to;
    for (int k = 0; k < 9; ++k) {
      D entries[kParts<T>];
      for (int part = 0; part < kParts<T>; ++part) entries[part] = of(parts[part]).m[k / 3][k % 3];
      to.m[k / 3][k % 3] = narrow<T>(entries);
    }
    return to;
  };
  for (int i = 0; i < kCorners; ++i)
    assign(narrowed([i](const PlasticLanes<D>& part) -> const Mat<D>& { return part.inverse[i]; }), plastic.inverse[i]);
  assign(narrowed([](const PlasticLanes<D>& part) -> const Mat<D>& { return part.mean; }), plastic.mean);
}

/// The same where the samples are known; branch_moduli: sum of g.
template <class T, bool kRelaxes>
HEXAPLAST_NOINLINE std::uint32_t flow_isolated_samples(
    const Model& model, const Linearization& at, double dt, const History& history, int block, int lane,
    std::uint32_t wanted, const MaterialLanes<Lanes<T>>& of, const int* elements, const SampleLanes<Lanes<T>>& element,
    const IsolatedLanes<Lanes<T>>& isolated, HistoryLanes<T, 9 * kCorners>& plastic_inverse,
    [[maybe_unused]] double branch_moduli, History& trial, ElementFlow* flows) {
  using V = Lanes<T>;
  const auto corners_of = [](auto& values) { return [&values](int e) { return values[e].data(); }; };
  HistoryLanes<T, kCorners> yield_stress(elements, corners_of(history.yield_stress));
  const Settings& settings = model.settings;
  Sym<V> relieved[kCorners], M[kCorners];
  for (int i = 0; i < kCorners; ++i) relieved[i] = isolated.whole[i];
  relieve(isolated.normals, relieved);

  std::uint32_t fails = isolated.fails;
  V rate = per_step<T>(model, elements, dt, &Material::flow_rate);
  if constexpr (kRelaxes) rate = min(rate, V(T(1 / (1 + branch_moduli))));  //                               eq. P18
  const V guard(static_cast<T>(settings.inversion_threshold)), none(T(0));
  V flowing(none), fraction[kCorners], norm[kCorners], strain[kCorners];
  for (int i = 0; i < kCorners; ++i) {
    fails |= bits<T>(not_of(determinant(element.F[i]) > guard));
    norm[i] = stress_norm_bound(relieved[i], settings.yield_norm);
    fails |= bits<T>(not_of(norm[i] < V(std::numeric_limits<T>::infinity())));
    fraction[i] = isolated_flow_fraction(norm[i], yield_stress[i], rate);
    flowing = max(flowing, fraction[i]);
    if (any_positive(fraction[i])) {
      Sym<V> log = symmetric_part(deviatoric_log(element.polar[i].S, fails));
      if constexpr (kRelaxes) log = sum(log, V(T(0.5)) / of.mu, isolated.of_branches[i]);
      M[i] = flow_direction(log, relieved[i], isolated.whole[i], of.mu, fraction[i]);
    } else {
      M[i] = {none, none, none, none, none, none};
    }
  }
  relieve(isolated.normals, M);  //                                                                          eq. P11

  V dissipated(none);
  for (int i = 0; i < kCorners; ++i) {
    const Mat<V> log = matrix(M[i]);
    const V mean = V(T(1.0 / 3)) * trace(M[i]);
    dissipated += dot(matrix(element.polar[i].S) * matrix(isolated.corotated[i]), log);
    strain[i] = V(T(std::sqrt(2.0 / 3.0))) *
                sqrt(squared_norm(Sym<V>{M[i].xx - mean, M[i].yy - mean, M[i].zz - mean, M[i].yz, M[i].zx, M[i].xy}));
    const int terms = exponential_terms(dot(log, log), fails);
    const Mat<V> change =
        isolated.plastic.inverse[i] * exponential_series(scaled(V(T(-1)), log), terms);  //                  eq. P12
    for (int part = 0; part < kParts<T>; ++part) {
      const auto has_flowed = widen(flowing, part) > D(0.0);  // what did not flow keeps its bits
      for (int k = 0; k < 9; ++k) {
        D& entry = plastic_inverse.at[9 * i + k][part];
        entry = select(has_flowed, entry + widen(change(k % 3, k / 3), part), entry);
      }
    }
  }
  const std::uint32_t done = wanted & ~fails;
  plastic_inverse.store(elements, done, [&](int e) { return trial.plastic_inverse[e][0].data(); });
  harden<T>(model, elements, fraction, norm, yield_stress);
  yield_stress.store(elements, done, corners_of(trial.yield_stress));
  HistoryLanes<T, kCorners> plastic_strain(elements, corners_of(history.plastic_strain));
  for (int part = 0; part < kParts<T>; ++part) {
    const int first = part * D::kCount;
    const auto has_flowed = widen(flowing, part) > D(0.0);
    for (int i = 0; i < kCorners; ++i) plastic_strain.at[i][part] += select(has_flowed, widen(strain[i], part), D(0.0));
    alignas(64) double work[D::kCount];
    D volume;
    if constexpr (kRelaxes)
      volume = widen(element.volume, part);  // `at` need not know it
    else
      volume = load(at.volume.data() + static_cast<std::size_t>(block) * kBlock + lane + first);
    store(select(has_flowed, D(1.0 / kCorners) * volume * widen(dissipated, part), D(0.0)), work);
    const std::uint32_t yielded = bits<double>(has_flowed);
    for (int k = 0; k < D::kCount; ++k)
      if (done >> (first + k) & 1)
        flows[elements[first + k]] = {.yielded = (yielded >> k & 1) != 0, .dissipated = work[k]};
  }
  plastic_strain.store(elements, done, corners_of(trial.plastic_strain));
  return wanted & fails;
}

/// The elements of one register of which the bits of `wanted` are set: history -> trial, flows. Returns those that it
/// cannot do.                                                                                          section 5.9
template <class T>
HEXAPLAST_NOINLINE std::uint32_t flow_isolated_lanes(const Model& model, const Linearization& at, double dt,
                                                     const History& history, int block, int lane, std::uint32_t wanted,
                                                     History& trial, ElementFlow* flows) {
  using V = Lanes<T>;
  const LaneElements<V> here(*model.partition, block, lane);
  HistoryLanes<T, 9 * kCorners> plastic_inverse(here.number,
                                                [&](int e) { return history.plastic_inverse[e][0].data(); });
  const MaterialLanes<V> of = material_lanes<T>(model.settings, model.lame_blocks, block, lane);
  CornerLanes<V> x, u;
  gather_elements<T>(model, at, block, lane, x, u);
  IsolatedLanes<V> isolated;
  narrow_plastic_inverse(plastic_inverse, isolated.plastic);
  const auto flow_as = [&]<bool kGeneral>() __attribute__((always_inline)) {
    ElementLanes<kGeneral, V> element;
    place_element(x, u, sampling_of(model.settings), &isolated.plastic, element);
    isolated.fails = decompose_or_fail(element);
    ModeLanes<V> volume_gradient;
    const PressureLanes<V> pressure = pressures(of, element, u, volume_gradient);
    sample_normals(element, isolated.normals);
    yielding_stress(element, of, pressure, model.settings.yield_stress_measure, nullptr, isolated.corotated,
                    isolated.whole);
    return flow_isolated_samples<T, false>(model, at, dt, history, block, lane, wanted, of, here.number, element,
                                           isolated, plastic_inverse, 0, trial, flows);
  };
  return at.is_general[block] ? flow_as.template operator()<true>() : flow_as.template operator()<false>();
}

/// B of a register of elements.                                                                              eq. P13
HEXAPLAST_INLINE void branch_stretches(const SampleLanes<D>& element, Sym<D> (&B)[kCorners]) {
  branch_stretches([&](int i) { return element.polar[i].S; }, B);
}

/// Takes the branches of a register of elements over the step: history -> trial. stress: what they add to that of the
/// samples then. Returns what they dissipate, times 8 [J/m^3].                                           eq. P13, P19
HEXAPLAST_NOINLINE D relax(const Branches& branches, const MaterialLanes<D>& of, const int* elements,
                           const SampleLanes<D>& element, std::uint32_t wanted, History& trial,
                           Sym<D> (&stress)[kCorners]) {
  Sym<D> change[kCorners], stretch[kCorners];
  branch_stretches(element, stretch);
  load_tensors(
      elements, [&](int e) { return branches.stretch[e][0].data(); }, change);
  const D none(0.0);
  for (int i = 0; i < kCorners; ++i) {
    change[i] = sum(stretch[i], D(-1.0), change[i]);
    stress[i] = {none, none, none, none, none, none};
  }
  store_tensors(stretch, elements, wanted, [&](int e) { return trial.branch_stretch[e][0].data(); });

  D dissipated(none);
  const D w = branch_weight(of.mu, of.lambda, branches);
  const std::size_t count = branches.steps.size();
  for (std::size_t k = 0; k < count; ++k) {
    const BranchStep& step = branches.steps[k];
    const D modulus = D(step.modulus) * of.mu, held(step.loss_held), mixed(step.loss_mixed), moved(step.loss_moved);
    Sym<D> b[kCorners];
    load_tensors(
        elements, [&](int e) { return branches.strain[e * count + k][0].data(); }, b);
    for (int i = 0; i < kCorners; ++i) {
      dissipated += modulus * (held * product(w, b[i], b[i]) + mixed * product(w, b[i], change[i]) +
                               moved * product(w, change[i], change[i]));
      b[i] = branch_strain(D(step.decay), b[i], D(step.response), change[i]);
      stress[i] = sum(stress[i], modulus + modulus, b[i]);
    }
    store_tensors(b, elements, wanted, [&](int e) { return trial.branch_strain[e * count + k][0].data(); });
  }
  for (Sym<D>& q : stress) q = branch_stress(w, q);
  return dissipated;
}

/// Stretch that has flowed leaves the branches too: trial, of the elements whose bits are set. element: samples after
/// the flow.                                                                                                 eq. P16
HEXAPLAST_NOINLINE void relieve_branches(const int* elements, const SampleLanes<D>& element, std::size_t num_branches,
                                         std::uint32_t yielded, History& trial) {
  const auto of_stretch = [&](int e) { return trial.branch_stretch[e][0].data(); };
  Sym<D> change[kCorners], stretch[kCorners];
  load_tensors(elements, of_stretch, change);
  branch_stretches(element, stretch);
  for (int i = 0; i < kCorners; ++i) change[i] = sum(stretch[i], D(-1.0), change[i]);
  store_tensors(stretch, elements, yielded, of_stretch);
  for (std::size_t k = 0; k < num_branches; ++k) {
    const auto of_strain = [&](int e) { return trial.branch_strain[e * num_branches + k][0].data(); };
    Sym<D> b[kCorners];
    load_tensors(elements, of_strain, b);
    for (int i = 0; i < kCorners; ++i) b[i] = sum(b[i], D(1.0), change[i]);
    store_tensors(b, elements, yielded, of_strain);
  }
}

/// Elements with branches, all of which relax: in double precision, in which the history is. section 5.10
template <bool kGeneral>
HEXAPLAST_NOINLINE std::uint32_t relax_lanes(const Model& model, const Linearization& at, double dt,
                                             const History& history, const Branches& branches, int block, int lane,
                                             std::uint32_t wanted, History& trial, ElementFlow* flows) {
  const LaneElements<D> here(*model.partition, block, lane);
  const Settings& settings = model.settings;
  const bool is_isolated = !history.plastic_inverse.empty();
  const MaterialLanes<D> of = material_lanes<double>(model.settings, model.lame_blocks, block, lane);
  CornerLanes<D> x, u;
  gather_elements<double>(model, at, block, lane, x, u);
  HistoryLanes<double, 9 * kCorners> plastic_inverse;
  IsolatedLanes<D> isolated;
  if (is_isolated) {
    plastic_inverse =
        HistoryLanes<double, 9 * kCorners>(here.number, [&](int e) { return history.plastic_inverse[e][0].data(); });
    narrow_plastic_inverse(plastic_inverse, isolated.plastic);
  }
  ElementLanes<kGeneral, D> element;
  const auto place = [&] {
    place_element(x, u, sampling_of(settings), is_isolated ? &isolated.plastic : nullptr, element);
    decompose(element);
  };
  place();
  const D lost = relax(branches, of, here.number, element, wanted, trial, isolated.of_branches);

  std::uint32_t left = 0;
  if (model.can_flow()) {
    ModeLanes<D> volume_gradient;
    const PressureLanes<D> pressure = pressures(of, element, u, volume_gradient);
    sample_normals(element, isolated.normals);
    yielding_stress(element, of, pressure, settings.yield_stress_measure, isolated.of_branches, isolated.corotated,
                    isolated.whole);
    isolated.fails = 0;
    left = flow_isolated_samples<double, true>(model, at, dt, history, block, lane, wanted, of, here.number, element,
                                               isolated, plastic_inverse, branches.moduli(), trial, flows);
    std::uint32_t yielded = 0;
    for (int k = 0; k < D::kCount; ++k)
      if ((wanted & ~left) >> k & 1) yielded |= static_cast<std::uint32_t>(flows[here.number[k]].yielded) << k;
    if (yielded) {
      narrow_plastic_inverse(plastic_inverse, isolated.plastic);
      place();
      relieve_branches(here.number, element, branches.steps.size(), yielded, trial);
    }
  } else {
    D lowest(std::numeric_limits<double>::infinity());
    for (const Mat<D>& F : element.F) lowest = min(lowest, determinant(F));
    const std::uint32_t inverted = bits<double>(lowest < D(0.0)),
                        skipped = bits<double>(lowest < D(settings.inversion_threshold));
    for (int k = 0; k < D::kCount; ++k)
      if (wanted >> k & 1)
        flows[here.number[k]] = {.inverted = (inverted >> k & 1) != 0, .skipped = (skipped >> k & 1) != 0};
  }
  alignas(64) double work[D::kCount];
  store(D(1.0 / kCorners) * element.volume * lost, work);
  for (int k = 0; k < D::kCount; ++k)
    if ((wanted & ~left) >> k & 1) flows[here.number[k]].dissipated += work[k];
  return left;
}

/// Of all registers of a block that hold some of the elements whose bits are set.
template <class T, class Flow>
std::uint32_t for_each_register(std::uint32_t wanted, const Flow& flow_register) {
  std::uint32_t left = 0;
  for (int lane = 0; lane < kBlock; lane += Lanes<T>::kCount)
    if (const std::uint32_t here = wanted >> lane & ((1u << Lanes<T>::kCount) - 1))
      left |= flow_register(lane, here) << lane;
  return left;
}

std::uint32_t flow(const Model& model, const Linearization& at, double dt, const History& history,
                   const Branches& branches, int block, History& trial, ElementFlow* flows) {
  std::uint32_t wanted = 0;
  for (int place = 0; place < kBlock; ++place) {
    const int e = model.partition->element(block, place);
    if (e >= 0 && !flows[e].idle) wanted |= 1u << place;
  }
  if (model.settings.yield_norm == YieldNorm::kSpectral && model.can_flow()) return wanted;
  if (branches.any())
    return for_each_register<double>(wanted, [&](int lane, std::uint32_t here) {
      return at.is_general[block]
                 ? relax_lanes<true>(model, at, dt, history, branches, block, lane, here, trial, flows)
                 : relax_lanes<false>(model, at, dt, history, branches, block, lane, here, trial, flows);
    });
  const auto flow_in = [&]<class T>() {
    return for_each_register<T>(wanted, [&](int lane, std::uint32_t here) {
      return flow_isolated_lanes<T>(model, at, dt, history, block, lane, here, trial, flows);
    });
  };
  return model.settings.precision == Precision::kMixed ? flow_in.template operator()<float>()
                                                       : flow_in.template operator()<double>();
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(flow);

std::uint32_t flow_block(const Model& model, const Linearization& at, double dt, const History& history,
                         const Branches& branches, int block, History& trial, ElementFlow* flows) {
  return HWY_DYNAMIC_DISPATCH(flow)(model, at, dt, history, branches, block, trial, flows);
}

}  // namespace hexaplast
#endif
