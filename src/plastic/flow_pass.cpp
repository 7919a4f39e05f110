// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the function at the end chooses at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "plastic/flow_pass.cpp"
#include "hwy/foreach_target.h"
//
#include <algorithm>
#include <cmath>

#include "hexaplast/plastic/rest_shape.hpp"
#include "kinematics/gradients-inl.hpp"
#include "kinematics/rotation-inl.hpp"
#include "material/corotated-inl.hpp"
#include "plastic/flow_pass.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

using V = Lanes<double>;

/// One number per element of a block.
struct alignas(64) BlockNumbers {
  double at[kBlock];
};

/// What the kernel reads and writes of the histories of a block, and its material.
struct BlockHistory {
  BlockNumbers rest_shape[3 * kCorners];  ///< y, [axis][corner]
  BlockNumbers map[9];                    ///< Pi, row by row
  BlockNumbers yield_stress[kCorners], rotation_yield[kCorners], plastic_strain[kCorners];
  BlockNumbers flow_rate, rotation_rate, hardening, original_volume, least_jacobian;
  BlockNumbers volume, dissipated;
};

HWY_INLINE Mat<V> matrix(const Sym<V>& S) { return {{{S.xx, S.xy, S.zx}, {S.xy, S.yy, S.yz}, {S.zx, S.yz, S.zz}}}; }

/// log S minus its mean, and whether the series held, per lane.                                            eq. 53
///
///   log S = log m + 2 atanh Z,  Z = (S - m)(S + m)^-1,  m = tr S / 3
///
/// Powers of Z^2 beyond the second are taken down by its characteristic equation: three numbers per term.
HWY_INLINE Mat<V> deviatoric_log(const Sym<V>& S, std::uint32_t& fails) {
  constexpr int kTerms = 13;
  constexpr double kLargest = 0.07;  // of |Z|^2: the first term left out is below 1e-17
  const V m = V(1.0 / 3) * (S.xx + S.yy + S.zz);
  const Mat<V> minus = matrix({S.xx - m, S.yy - m, S.zz - m, S.yz, S.zx, S.xy});
  const Mat<V> plus = matrix({S.xx + m, S.yy + m, S.zz + m, S.yz, S.zx, S.xy});
  V det;
  const Mat<V> Z = minus * reciprocal(plus, det);  // the reciprocal of a symmetric matrix is its inverse
  const V size = dot(Z, Z);
  fails |= bits<double>(hn::Not(hn::And(size<V(kLargest), m> V(0.0))));

  const Mat<V> W = Z * Z;
  const V i1 = W(0, 0) + W(1, 1) + W(2, 2);
  const V i2 = V(0.5) * (i1 * i1 - dot(W, W));
  const Mat<V> cof = cofactor(W);
  const V i3 = W(0, 0) * cof(0, 0) + W(0, 1) * cof(0, 1) + W(0, 2) * cof(0, 2);
  V a(1.0 / (2 * kTerms + 1)), b(0.0), c(0.0);  // a + b W + c W^2
  for (int k = kTerms - 1; k >= 0; --k) {
    const V above = c;
    c = b + above * i1;
    b = a - above * i2;
    a = above * i3 + V(1.0 / (2 * k + 1));
  }
  const Mat<V> WW = W * W;
  Mat<V> series;
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s) series(r, s) = (r == s ? a : V(0.0)) + b * W(r, s) + c * WW(r, s);
  Mat<V> log = Z * series;
  const V mean = V(1.0 / 3) * (log(0, 0) + log(1, 1) + log(2, 2));
  for (int k = 0; k < 3; ++k) log(k, k) -= mean;
  for (int k = 0; k < 9; ++k) log.m[k / 3][k % 3] *= V(2.0);
  return log;
}

/// exp M of a symmetric matrix without trace, by its characteristic equation M^3 = j M + d.                  eq. 54
HWY_INLINE Mat<V> exponential(const Mat<V>& M) {
  constexpr int kTerms = 15;  // |M| < 0.7: the first term left out is below 1e-15
  const V j = V(0.5) * dot(M, M);
  const Mat<V> cof = cofactor(M);
  const V d = M(0, 0) * cof(0, 0) + M(0, 1) * cof(0, 1) + M(0, 2) * cof(0, 2);
  V a(1.0), b(0.0), c(0.0);  // Horner: 1 + M (1 + M / 2 (1 + M / 3 (...)))
  for (int k = kTerms; k >= 1; --k) {
    const V share(1.0 / k), above = c;
    c = share * b;
    b = share * (a + above * j);
    a = V(1.0) + share * above * d;
  }
  const Mat<V> MM = M * M;
  Mat<V> E;
  for (int r = 0; r < 3; ++r)
    for (int s = 0; s < 3; ++s) E(r, s) = (r == s ? a : V(0.0)) + b * M(r, s) + c * MM(r, s);
  return E;
}

/// clamp(rate dt (value - threshold) / value, 0, 1); 0 where value <= threshold.                             eq. 21
HWY_INLINE V flow_share(V value, V threshold, V rate_dt) {
  const V share = min(rate_dt * (value - threshold) / value, V(1.0));
  return select(value > threshold, share, V(0.0));
}

/// The elements of one register. Returns those that it cannot do; the trial numbers of these are not valid.
template <bool kGeneral>
HWY_INLINE std::uint32_t flow_lanes(const Model& model, const Linearization& at, double dt, int block, int lane,
                                    BlockHistory& h, std::uint32_t& yielded) {
  const Settings& settings = model.settings;
  const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
  CornerLanes<V> x, u;
  gather(*model.partition, block, lane, at.material.data(), x);
  gather(*model.partition, block, lane, at.world.data(), u);
  replace_absent(present, x);
  replace_absent(present, u);
  RestLanes<kGeneral, V> rest;
  rest_operator(x, settings.gradient, rest);
  const GradientLanes<kGeneral, V> gradient(rest, u);
  const double* lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  const V mu = load(lame), lambda = load(lame + kBlock), step(dt);
  const V rate = step * load(h.flow_rate.at + lane), rotation_rate = step * load(h.rotation_rate.at + lane),
          hardening = load(h.hardening.at + lane);

  // near the guard of the material shape the exact ratios decide
  std::uint32_t fails = bits<double>(hn::Not(rest.least_jacobian > load(h.least_jacobian.at + lane)));
  Mat<V> R_centre;
  if (model.can_rotate) {
    const PolarLanes<V> centre = polar(centre_gradient(x, u));
    fails |= centre.doubtful;
    R_centre = centre.R;
  }
  Mat<V> Pi;
  for (int k = 0; k < 9; ++k) Pi.m[k / 3][k % 3] = load(h.map[k].at + lane);

  V dissipated(0.0), flowing(0.0);
  V y[kCorners][3], mean[3] = {V(0.0), V(0.0), V(0.0)};
  for (int i = 0; i < kCorners; ++i) {
    const Mat<V> F = gradient(i);
    const PolarLanes<V> FRS = polar(F);
    fails |= FRS.doubtful;
    const Mat<V> cof = cofactor(F);
    const V det = F(0, 0) * cof(0, 0) + F(0, 1) * cof(0, 1) + F(0, 2) * cof(0, 2);
    fails |= bits<double>(hn::Not(det > V(settings.inversion_threshold)));

    V at_corner[3];
    for (int a = 0; a < 3; ++a) at_corner[a] = load(h.rest_shape[a * kCorners + i].at + lane);
    const auto turn = [&](const Mat<V>& M, bool transposed) {
      V turned[3];
      for (int a = 0; a < 3; ++a)
        turned[a] = transposed ? M(0, a) * at_corner[0] + M(1, a) * at_corner[1] + M(2, a) * at_corner[2]
                               : M(a, 0) * at_corner[0] + M(a, 1) * at_corner[1] + M(a, 2) * at_corner[2];
      for (int a = 0; a < 3; ++a) at_corner[a] = turned[a];
    };
    turn(Pi, false);

    if (model.can_stretch) {
      const Sym<V> sigma = stress(FRS.S, mu, lambda);
      const V norm = stress_norm_bound(sigma, settings.yield_norm);
      const V tau = load(h.yield_stress[i].at + lane);
      const V share = flow_share(norm, tau, rate);  // gamma
      if (bits<double>(share > V(0.0))) {
        Mat<V> flow = deviatoric_log(FRS.S, fails);
        for (int k = 0; k < 9; ++k) flow.m[k / 3][k % 3] *= share;
        turn(exponential(flow), false);  // S^p                                                              eq. 22
        flowing = max(flowing, share);
        dissipated += dot(matrix(sigma), flow);
        store(load(h.plastic_strain[i].at + lane) + V(std::sqrt(2.0 / 3.0)) * sqrt(dot(flow, flow)),
              h.plastic_strain[i].at + lane);
        // select: a threshold of infinity times a share of zero is no number
        store(select(share > V(0.0), max(V(0.0), tau + hardening * share * norm), tau),
              h.yield_stress[i].at + lane);  // eq. 23
      }
    }
    if (model.can_rotate) {
      const RotationVectorLanes<V> Q = rotation_log(transposed_product(R_centre, FRS.R));
      fails |= Q.near_half_turn;
      const V tau = load(h.rotation_yield[i].at + lane);
      const V share = flow_share(Q.angle, tau, rotation_rate);  // eta
      if (bits<double>(share > V(0.0))) {
        turn(rotation_exp(Q, share), false);  // R^p                                                         eq. 26
        flowing = max(flowing, share);
        store(max(V(0.0), tau + hardening * share * Q.angle), h.rotation_yield[i].at + lane);  // eq. 25
      }
    }
    turn(Pi, true);
    for (int a = 0; a < 3; ++a) {
      y[i][a] = at_corner[a];
      mean[a] += V(1.0 / kCorners) * at_corner[a];
    }
  }

  const V beta = rest.volume / load(h.original_volume.at + lane);
  const V c(settings.volume_restitution * dt);
  const V scale = select(abs(beta - V(1.0)) < V(kVolumeAtRest), V(1.0),
                         min(max(V(1.0) + c * (V(1.0) - beta), V(kLeastScale)), V(kGreatestScale)));  // eq. 28
  // what did not flow keeps its bits
  const auto flows = flowing > V(0.0);
  for (int i = 0; i < kCorners; ++i)
    for (int a = 0; a < 3; ++a) {
      double* const to = h.rest_shape[a * kCorners + i].at + lane;
      store(scale * select(flows, y[i][a] - mean[a], load(to)), to);
    }
  store(V(1.0 / kCorners) * rest.volume * dissipated, h.dissipated.at + lane);
  store(rest.volume, h.volume.at + lane);
  yielded |= bits<double>(flows) << lane;
  return fails;
}

std::uint32_t flow(const Model& model, const Linearization& at, double dt, const History& history, int block,
                   History& trial, ElementFlow* flows) {
  BlockHistory h;
  std::uint32_t wanted = 0, left = 0;
  const double threshold = model.settings.inversion_threshold;
  for (int place = 0; place < kBlock; ++place) {
    const int given = model.partition->element(block, place);
    const int e = given < 0 ? model.partition->element(block, 0) : given;
    const Material& material = model.material(e);
    const ElementPoints& y = history.rest_shape[e];
    for (int k = 0; k < 3 * kCorners; ++k) h.rest_shape[k].at[place] = y.data()[k];
    for (int k = 0; k < 9; ++k) h.map[k].at[place] = history.rotation_map[e](k / 3, k % 3);
    for (int i = 0; i < kCorners; ++i) {
      h.yield_stress[i].at[place] = history.yield_stress[e][i];
      h.rotation_yield[i].at[place] = history.rotation_yield[e][i];
      h.plastic_strain[i].at[place] = history.plastic_strain[e][i];
    }
    h.flow_rate.at[place] = material.flow_rate;
    h.rotation_rate.at[place] = material.rotation_flow_rate;
    h.hardening.at[place] = material.hardening;
    h.original_volume.at[place] = model.volume[e];
    h.least_jacobian.at[place] =
        1.01 * threshold * *std::max_element(model.corner_jacobian[e].begin(), model.corner_jacobian[e].end());
    if (given < 0 || flows[e].idle) continue;
    wanted |= 1u << place;
    if (model.tracks_plastic_stretch) left |= 1u << place;
  }
  if (model.settings.yield_norm == YieldNorm::kSpectral || model.maps_per_element() > 1) return wanted;

  std::uint32_t yielded = 0;
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    if (!(wanted >> lane & ((1u << V::kCount) - 1))) continue;
    const std::uint32_t fails = at.is_general[block] ? flow_lanes<true>(model, at, dt, block, lane, h, yielded)
                                                     : flow_lanes<false>(model, at, dt, block, lane, h, yielded);
    left |= fails << lane;
  }

  for (int place = 0; place < kBlock; ++place) {
    if (!(wanted & ~left & 1u << place)) continue;
    const int e = model.partition->element(block, place);
    for (int k = 0; k < 3 * kCorners; ++k) trial.rest_shape[e].data()[k] = h.rest_shape[k].at[place];
    trial.rotation_map[e] = history.rotation_map[e];
    for (int i = 0; i < kCorners; ++i) {
      trial.yield_stress[e][i] = h.yield_stress[i].at[place];
      trial.rotation_yield[e][i] = h.rotation_yield[i].at[place];
      trial.plastic_strain[e][i] = h.plastic_strain[i].at[place];
    }
    flows[e] = {.yielded = (yielded >> place & 1) != 0,
                .volume_error = std::abs(h.volume.at[place] / model.volume[e] - 1),
                .dissipated = h.dissipated.at[place]};
  }
  return wanted & left;
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

}  // namespace hexaplast
#endif
