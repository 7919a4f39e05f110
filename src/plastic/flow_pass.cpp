// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the function at the end chooses at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "plastic/flow_pass.cpp"
#include "hwy/foreach_target.h"
//
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/transpose-inl.hpp"
#include "element/element-inl.hpp"
#include "kinematics/rotation-inl.hpp"
#include "material/stress_norm-inl.hpp"
#include "plastic/flow_pass.hpp"
#include "plastic/point_flow-inl.hpp"
#include "plastic/rest_shape-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

using V = Lanes<double>;

/// The elements of one register; in the place of those that are not there the first one of the block.
struct LaneElements {
  LaneElements(const Model& model, int block, int lane) {
    for (int k = 0; k < V::kCount; ++k) {
      const int e = model.partition->element(block, lane + k);
      number[k] = e < 0 ? model.partition->element(block, 0) : e;
    }
  }
  int number[V::kCount];
};

/// The elements of one register of which the bits of `wanted` are set: history -> trial, flows. Returns those that it
/// cannot do.
HWY_NOINLINE std::uint32_t flow_lanes(const Model& model, const Linearization& at, double dt, const History& history,
                                      int block, int lane, std::uint32_t wanted, History& trial, ElementFlow* flows) {
  const LaneElements here(model, block, lane);
  const int* const elements = here.number;
  const auto load_corners = [&](const auto& values, V* numbers) {
    load_elements<kCorners>(addresses<const double>(elements, [&](int e) { return values[e].data(); }), numbers);
  };
  V rest_shape[3 * kCorners], map[9], yield_stress[kCorners], rotation_yield[kCorners], plastic_strain[kCorners];
  const auto y_of = [](auto& of) { return [&of](int e) { return of.rest_shape[e].data(); }; };
  const auto map_of = [](auto& of) { return [&of](int e) { return of.rotation_map[e].data(); }; };
  load_elements<3 * kCorners>(addresses<const double>(elements, y_of(history)), rest_shape);
  load_elements<9>(addresses<const double>(elements, map_of(history)), map);
  load_corners(history.yield_stress, yield_stress);
  if (model.can_rotate) load_corners(history.rotation_yield, rotation_yield);
  load_corners(history.plastic_strain, plastic_strain);

  const Settings& settings = model.settings;
  const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
  CornerLanes<V> x, u;
  gather(*model.partition, block, lane, at.plastic_rest.data(), x);
  gather(*model.partition, block, lane, at.current.data(), u);
  replace_absent(present, x);
  replace_absent(present, u);
  SampleLanes<V> element;
  for_shape(
      at.is_general[block] != 0,
      sampling_of(settings).assumed, [&]<bool kGeneral, Assumed kAssumed>() __attribute__((always_inline)) {
        ElementLanes<kGeneral, kAssumed, V> shape;
        place_element(x, u, sampling_of(settings), shape);
        element = shape;
      });
  std::uint32_t fails = 0;
  for (int first = 0; first < kCorners; first += kAtOnce) {
    polars<kAtOnce>(element.F + first, element.polar + first);
    for (int m = 0; m < kAtOnce; ++m) fails |= element.polar[first + m].doubtful;
  }
  Mat<V> R[kCorners];  // of the samples themselves
  for (int i = 0; i < kCorners; ++i) R[i] = element.polar[i].R;
  if (sampling_of(settings).one_rotation) decompose(sampling_of(settings), element);
  const double* lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  const MaterialLanes<V> of(settings, load(lame), load(lame + kBlock));
  ModeLanes<V> volume_gradient;
  const PressureLanes<V> pressure = pressures(of, element, u, volume_gradient);
  const V step(dt);
  const auto material = [&](double Material::*constant) {
    if (model.materials.size() == 1) return V(model.materials[0].*constant);
    return gather_numbers(elements, [&](int e) { return model.materials[e].*constant; });
  };
  const V rate = step * material(&Material::flow_rate), rotation_rate = step * material(&Material::rotation_flow_rate),
          hardening = material(&Material::hardening);

  // near the guard of the plastic rest shape the exact ratios decide
  const V largest_jacobian = gather_numbers(elements, [&](int e) { return model.largest_jacobian[e]; });
  fails |= bits<double>(hn::Not(element.min_jacobian > V(1.01 * settings.inversion_threshold) * largest_jacobian));
  Mat<V> R_centre;
  set_zero(R_centre);
  if (model.can_rotate) {
    const PolarLanes<V> centre = polar(centre_gradient(x, u));
    fails |= centre.doubtful;
    R_centre = centre.R;
  }
  Mat<V> Pi;
  for (int k = 0; k < 9; ++k) Pi(k % 3, k / 3) = map[k];

  // a corner at a time: those of elements that fail are written again
  const auto load_plastic_stretch = [&](int i, Mat<V>& stretch) {
    V numbers[9];
    load_elements<9>(addresses<const double>(elements, [&](int e) { return history.plastic_stretch[e][i].data(); }),
                     numbers);
    for (int k = 0; k < 9; ++k) stretch(k % 3, k / 3) = numbers[k];
  };
  const auto store_plastic_stretch = [&](int i, const Mat<V>& stretch) {
    V numbers[9];
    for (int k = 0; k < 9; ++k) numbers[k] = stretch(k % 3, k / 3);
    store_elements<9>(numbers, wanted,
                      addresses<double>(elements, [&](int e) { return trial.plastic_stretch[e][i].data(); }));
  };

  V dissipated(0.0), flowing(0.0);
  V y[kCorners][3], mean[3] = {V(0.0), V(0.0), V(0.0)};
  const double increment_weight = sampling_of(settings).increment_weight();
  const bool is_weighted = increment_weight != 1;
  Mat<V> mean_increment;
  set_zero(mean_increment);
  for (int i = 0; i < kCorners; ++i) {
    const Mat<V>& F = element.F[i];
    const PolarLanes<V>& FRS = element.polar[i];
    const Mat<V> cof = cofactor(F);
    const V det = F(0, 0) * cof(0, 0) + F(0, 1) * cof(0, 1) + F(0, 2) * cof(0, 2);
    fails |= bits<double>(hn::Not(det > V(settings.inversion_threshold)));

    V at_corner[3];
    for (int a = 0; a < 3; ++a) at_corner[a] = rest_shape[a * kCorners + i];
    const auto turn = [&](const Mat<V>& M, bool transposed) {
      V turned[3];
      for (int a = 0; a < 3; ++a)
        turned[a] = transposed ? M(0, a) * at_corner[0] + M(1, a) * at_corner[1] + M(2, a) * at_corner[2]
                               : M(a, 0) * at_corner[0] + M(a, 1) * at_corner[1] + M(a, 2) * at_corner[2];
      for (int a = 0; a < 3; ++a) at_corner[a] = turned[a];
    };
    turn(Pi, false);
    Mat<V> increment;
    set_zero(increment);
    for (int k = 0; k < 3; ++k) increment(k, k) = V(1.0);

    if (sampling_of(settings).one_rotation) {  // stretches may be negative though F is not inverted
      const V t(settings.inversion_threshold), xx = FRS.S.xx - t, yy = FRS.S.yy - t,
                                               minor = xx * yy - FRS.S.xy * FRS.S.xy;
      const V whole = determinant(Sym<V>{xx, yy, FRS.S.zz - t, FRS.S.yz, FRS.S.zx, FRS.S.xy});
      fails |= bits<double>(hn::Not(min(min(xx, minor), whole) > V(0.0)));
    }

    Mat<V> plastic_stretch;
    set_zero(plastic_stretch);
    if (model.tracks_plastic_stretch) load_plastic_stretch(i, plastic_stretch);
    if (model.can_stretch) {
      const Sym<V> sigma =
          stress(of.law, of.mooney_fraction, FRS.S, of.mu, pressure.in_stress_at(dilatation(of.law, FRS.S)));
      const V norm = stress_norm_bound(sigma, settings.yield_norm);
      fails |= bits<double>(hn::Not(norm < V(std::numeric_limits<double>::infinity())));
      const V tau = yield_stress[i];
      const V fraction = flow_fraction(norm, tau, rate, norm);  // gamma
      if (any_positive(fraction)) {
        const Mat<V> Sp =
            stretch_increment(FRS.S, dissipating(of.law, FRS.S, sigma), fraction, plastic_strain[i], dissipated, fails);
        turn(Sp, false);
        if (is_weighted) increment = Sp;
        flowing = max(flowing, fraction);
        yield_stress[i] = hardened(tau, hardening, fraction, norm);
        if (model.tracks_plastic_stretch) {
          const Mat<V> next = transposed_product(Pi, Sp * (Pi * plastic_stretch));
          for (int k = 0; k < 9; ++k)
            plastic_stretch.m[k / 3][k % 3] =
                select(fraction > V(0.0), next.m[k / 3][k % 3], plastic_stretch.m[k / 3][k % 3]);
        }
      }
    }
    if (model.tracks_plastic_stretch) store_plastic_stretch(i, plastic_stretch);
    if (model.can_rotate) {
      const RotationVector<V> Q = rotation_log(transposed_product(R_centre, R[i]));
      fails |= Q.near_half_turn;
      const V tau = rotation_yield[i];
      const V fraction = flow_fraction(Q.angle, tau, rotation_rate, Q.angle);  // eta
      if (any_positive(fraction)) {
        const Mat<V> Rp = rotation_exp(Q, fraction);  //                                                        eq. 26
        turn(Rp, false);
        if (is_weighted) increment = Rp * increment;
        flowing = max(flowing, fraction);
        rotation_yield[i] = hardened(tau, hardening, fraction, Q.angle);
      }
    }
    turn(Pi, true);
    for (int a = 0; a < 3; ++a) y[i][a] = at_corner[a];
    if (is_weighted)
      for (int k = 0; k < 9; ++k) mean_increment.m[k / 3][k % 3] += V(1.0 / kCorners) * increment.m[k / 3][k % 3];
  }
  if (is_weighted) {
    const Mat<V> of_all = transposed_product(Pi, mean_increment * Pi);
    for (int i = 0; i < kCorners; ++i)
      for (int a = 0; a < 3; ++a) {
        V alike(0.0);
        for (int b = 0; b < 3; ++b) alike += of_all(a, b) * rest_shape[b * kCorners + i];
        y[i][a] = alike + V(increment_weight) * (y[i][a] - alike);
      }
  }
  for (int i = 0; i < kCorners; ++i)
    for (int a = 0; a < 3; ++a) mean[a] += V(1.0 / kCorners) * y[i][a];

  const V beta = element.volume / gather_numbers(elements, [&](int e) { return model.volume[e]; });
  const V scale = restitution_scale(beta, V(settings.volume_restitution * dt));
  // what did not flow keeps its bits
  const auto has_flowed = flowing > V(0.0);
  for (int i = 0; i < kCorners; ++i)
    for (int a = 0; a < 3; ++a) {
      V& to = rest_shape[a * kCorners + i];
      to = scale * select(has_flowed, y[i][a] - mean[a], to);
    }

  const std::uint32_t done = wanted & ~fails;
  const auto store_corners = [&](auto& values, const V* numbers) {
    store_elements<kCorners>(numbers, done, addresses<double>(elements, [&](int e) { return values[e].data(); }));
  };
  store_elements<3 * kCorners>(rest_shape, done, addresses<double>(elements, y_of(trial)));
  store_elements<9>(map, done, addresses<double>(elements, map_of(trial)));
  store_corners(trial.yield_stress, yield_stress);
  if (model.can_rotate) store_corners(trial.rotation_yield, rotation_yield);
  store_corners(trial.plastic_strain, plastic_strain);

  const std::uint32_t yielded = bits<double>(has_flowed);
  alignas(64) double volume_error[V::kCount], work[V::kCount];
  store(abs(beta - V(1.0)), volume_error);
  store(V(1.0 / kCorners) * element.volume * dissipated, work);
  for (int k = 0; k < V::kCount; ++k)
    if (done >> k & 1)
      flows[elements[k]] = {.yielded = (yielded >> k & 1) != 0, .volume_error = volume_error[k], .dissipated = work[k]};
  return wanted & fails;
}

std::uint32_t flow(const Model& model, const Linearization& at, double dt, const History& history, int block,
                   History& trial, ElementFlow* flows) {
  std::uint32_t wanted = 0;
  for (int place = 0; place < kBlock; ++place) {
    const int e = model.partition->element(block, place);
    if (e >= 0 && !flows[e].idle && !flows[e].restores) wanted |= 1u << place;
  }
  if (model.settings.yield_norm == YieldNorm::kSpectral || model.maps_per_element() > 1) return wanted;

  std::uint32_t left = 0;
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    const std::uint32_t here = wanted >> lane & ((1u << V::kCount) - 1);
    if (!here) continue;
    left |= flow_lanes(model, at, dt, history, block, lane, here, trial, flows) << lane;
  }
  return left;
}

// In lanes, so that volumes have the bits that they have where the whole block flows.
void restore(const Model& model, const Linearization& at, double dt, const History& history, int block, History& trial,
             ElementFlow* flows) {
  std::uint32_t wanted = 0;
  for (int place = 0; place < kBlock; ++place) {
    const int e = model.partition->element(block, place);
    if (e >= 0 && flows[e].restores) wanted |= 1u << place;
  }
  const V rate(model.settings.volume_restitution * dt);
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    const std::uint32_t here = wanted >> lane & ((1u << V::kCount) - 1);
    if (!here) continue;
    const LaneElements elements(model, block, lane);
    const auto y_of = [](auto& of) { return [&of](int e) { return of.rest_shape[e].data(); }; };
    V rest_shape[3 * kCorners];
    load_elements<3 * kCorners>(addresses<const double>(elements.number, y_of(history)), rest_shape);
    V volume;
    if (at.is_current) {
      volume = load(at.volume.data() + static_cast<std::size_t>(block) * kBlock + lane);
    } else {
      CornerLanes<V> x, u;
      gather(*model.partition, block, lane, at.plastic_rest.data(), x);
      gather(*model.partition, block, lane, at.current.data(), u);
      const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
      replace_absent(present, x);
      replace_absent(present, u);
      for_shape(
          at.is_general[block] != 0,
          sampling_of(model.settings).assumed, [&]<bool kGeneral, Assumed kAssumed>() __attribute__((always_inline)) {
            ElementLanes<kGeneral, kAssumed, V> shape;
            place_element(x, u, sampling_of(model.settings), shape);
            volume = shape.rest.volume;
          });
    }
    const V beta = volume / gather_numbers(elements.number, [&](int e) { return model.volume[e]; });
    const V scale = restitution_scale(beta, rate);
    for (V& number : rest_shape) number = scale * number;
    store_elements<3 * kCorners>(rest_shape, here, addresses<double>(elements.number, y_of(trial)));
    alignas(64) double volume_error[V::kCount];
    store(abs(beta - V(1.0)), volume_error);
    for (int k = 0; k < V::kCount; ++k)
      if (here >> k & 1) flows[elements.number[k]].volume_error = volume_error[k];
  }
}

std::uint32_t collapsed(const Model& model, const double* positions, double ratio, int block) {
  std::uint32_t near = 0, present = 0;
  for (int place = 0; place < kBlock; ++place)
    if (model.partition->element(block, place) >= 0) present |= 1u << place;
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    const LaneElements elements(model, block, lane);
    CornerLanes<V> x;
    gather(*model.partition, block, lane, positions, x);
    EdgeLanes<V> e;
    edges(x, e);
    V lowest(std::numeric_limits<double>::infinity());
    for (int i = 0; i < kCorners; ++i) {
      V det;
      reciprocal(edges_at(e, i), det);
      lowest = min(lowest, V(0.125) * det);
    }
    const V largest = gather_numbers(elements.number, [&](int n) { return model.largest_jacobian[n]; });
    near |= bits<double>(hn::Not(lowest > V(ratio) * largest)) << lane;
  }
  return near & present;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(flow);

std::uint32_t flow_block(const Model& model, const Linearization& at, double dt, const History& history, int block,
                         History& trial, ElementFlow* flows) {
  return HWY_DYNAMIC_DISPATCH(flow)(model, at, dt, history, block, trial, flows);
}

HWY_EXPORT(restore);

void restore_block(const Model& model, const Linearization& at, double dt, const History& history, int block,
                   History& trial, ElementFlow* flows) {
  HWY_DYNAMIC_DISPATCH(restore)(model, at, dt, history, block, trial, flows);
}

HWY_EXPORT(collapsed);

std::uint32_t nearly_collapsed(const Model& model, const double* positions, double ratio, int block) {
  return HWY_DYNAMIC_DISPATCH(collapsed)(model, positions, ratio, block);
}

}  // namespace hexaplast
#endif
