// SPDX-License-Identifier: LGPL-2.1-or-later
// Plastic flow on a GPU.                                                                            theory.md
// section 5.9
#pragma once

#include "device/elastic.cuh"
#include "element/isolated-inl.hpp"
#include "plastic/point_flow-inl.hpp"

namespace hexaplast::one_number {

/// History of samples: G (9), tau [Pa], accumulated strain [-], each [brick][number][sample][lane].
template <class N>
struct Plastic {
  N *G, *tau, *strain;
};

/// A - sum_n s_n c_n n_n n_n^T, of one sample.                                                            eq. P8, P11
__device__ inline void relieve_by(const V (&c)[3], const Signs& s, const Mat<V>& normals, Sym<V>& A) {
  for (int n = 0; n < 3; ++n) {
    const V scale = s.at[n] * c[n], x = normals(n, 0), y = normals(n, 1), z = normals(n, 2);
    A.xx -= scale * x * x, A.yy -= scale * y * y, A.zz -= scale * z * z;
    A.yz -= scale * y * z, A.zx -= scale * z * x, A.xy -= scale * x * y;
  }
}
/// What of c is of this sample.
__device__ inline void add_normal(const Mat<V>& normals, const Signs& s, const Sym<V>& A, V (&c)[3]) {
  const Mat<V> all = normals * matrix(A);
  for (int n = 0; n < 3; ++n) c[n] += V(0.125f) * s.at[n] * dot(all.m[n], normals.m[n]);
}

/// What samples keep from one loop to the next.
struct KeptSamples {
  __device__ void set(const Place& my, int i, int k, V a) { at[i][k][my.lane] = a; }
  __device__ V number_at(const Place& my, int i, int k) const { return V(at[i][k][my.lane]); }
  __device__ void set(const Place& my, int i, const Sym<V>& A) {
    const V six[6] = {A.xx, A.yy, A.zz, A.yz, A.zx, A.xy};
    for (int k = 0; k < 6; ++k) set(my, i, k, six[k]);
  }
  __device__ Sym<V> symmetric_at(const Place& my, int i) const {
    const auto of = [&](int k) { return number_at(my, i, k); };
    return {of(0), of(1), of(2), of(3), of(4), of(5)};
  }
  __device__ Mat<V> normals_at(const Place& my, int i) const {
    Mat<V> rows;
    for (int k = 0; k < 9; ++k) rows.m[k / 3][k % 3] = number_at(my, i, 7 + k);
    return rows;
  }
  float at[kCorners][16][kWidth];  ///< S, then M (6); gamma |sigma|; face normals (9)
};

constexpr float kNoLimit = 1e30f, kNearLimit = 0.9999f;  ///< of the stretch at which hexahedra break

struct FlowRule {
  float dt;                                     ///< [s]
  float least_det = 0.1f, least_corner = 0.3f;  ///< below these a hexahedron is left over
  bool is_true_stress = true;                   ///< YieldStressMeasure::kCauchy
};

/// History after a step at positions x. status: kIsLeft where a hexahedron is for the CPU, and keeps its history;
/// kFlows; kMayBreak. value: what it dissipates [J]. Three loops over samples find the stretches, what flows, and the
/// new history.
///                                                                            eq. P6 to P12; plastic/flow_pass.cpp
__global__ void __launch_bounds__(kWidth* kBricksOfBlock, 6)
    flow(Layout at, const float* rest, FlowRule rule, const double4_32a* x, Plastic<const double> before,
         const float* mean_before, Plastic<double> after, std::uint8_t* status, float* value) {
  __shared__ KeptSamples shared[kBricksOfBlock];
  const Place my;
  if (my.brick >= at.num_bricks) return;
  KeptSamples& kept = shared[my.here];
  const auto of_rest = [&](int k) { return of_brick(rest, kRestNumbers, my, k); };
  const V volume = of_rest(9), mu = of_rest(10), lambda = of_rest(11), one(1.0f), eighth(0.125f);
  const V free = free_modulus(mu, lambda), rate = of_rest(12) * V(rule.dt);
  const float hardening = of_rest(13);
  std::uint32_t fails = 0;
  V theta_sum(0.0f), excess, c[3] = {V(0.0f), V(0.0f), V(0.0f)}, c_of_mean[3] = {V(0.0f), V(0.0f), V(0.0f)};
  {
    PlacedHexahedron h;
    place_hexahedron(at, my, rest, x, mean_before, h);
    ModeLanes<V> gradient;
    excess = volume_of_placed(h, gradient) / volume - one;
    fails = h.mean.doubtful;
#pragma unroll 1
    for (int i = 0; i < kCorners; ++i) {
      const Signs signs(i);
      Mat<V> edges, columns;
      columns_at(h.modes, h.a, signs, edges, columns);
      const Mat<V> G = history_at(before.G, my, i), F = transposed_product(columns, h.dual * G);
      PolarLanes<V> polar;
      polars<1>(&F, &polar);
      fails |= polar.doubtful;
      if (!(determinant(edges) > rule.least_corner * volume && determinant(F) > rule.least_det)) fails = 1;
      const V theta = dilatation(ElasticLaw::kCorotated, polar.S);
      theta_sum += theta;
      const Mat<V> normals = face_normals(G, h.dual);
      const Sym<V> sigma = stress(ElasticLaw::kCorotated, 0, polar.S, mu, free * theta);
      if (rule.is_true_stress) {
        add_normal(normals, signs, cauchy_stress(polar.S, sigma, V(0.0f), one + excess), c);
        add_normal(normals, signs, polar.S, c_of_mean);
      } else {
        add_normal(normals, signs, sigma, c);  // what all samples share is relieved of nothing
      }
      kept.set(my, i, polar.S);
      for (int k = 0; k < 9; ++k) kept.set(my, i, 7 + k, normals.m[k / 3][k % 3]);
    }
  }

  const V mean_theta = eighth * theta_sum;
  V k_n[3] = {V(0.0f), V(0.0f), V(0.0f)}, flowing(0.0f), work(0.0f), along[3] = {V(0.0f), V(0.0f), V(0.0f)};
  for (int n = 0; n < 3; ++n) c[n] -= free * mean_theta / (one + excess) * c_of_mean[n];
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    const Signs signs(i);
    const Sym<V> S = kept.symmetric_at(my, i);
    const V theta = dilatation(ElasticLaw::kCorotated, S);
    const Sym<V> sigma = stress(ElasticLaw::kCorotated, 0, S, mu, free * (theta - mean_theta));
    const V pressure = lambda * excess;
    Sym<V> whole = {sigma.xx + pressure, sigma.yy + pressure, sigma.zz + pressure, sigma.yz, sigma.zx, sigma.xy};
    if (rule.is_true_stress) whole = cauchy_stress(S, sigma, pressure, one + excess);
    const Mat<V> normals = kept.normals_at(my, i);
    Sym<V> relieved = whole, M = {V(0.0f), V(0.0f), V(0.0f), V(0.0f), V(0.0f), V(0.0f)};
    relieve_by(c, signs, normals, relieved);
    const V norm = stress_norm_bound(relieved, YieldNorm::kVonMises);
    const V tau(static_cast<float>(before.tau[place_of_sample(my, 1, 0, i)]));
    const V fraction = isolated_flow_fraction(norm, tau, rate);
    if (!(norm < 1e30f)) fails = 1;
    if (fraction > 0) {
      M = flow_direction(symmetric_part(deviatoric_log(S, fails)), relieved, whole, mu, fraction);
      if (!(squared_norm(M) < 1)) fails = 1;  // far within the series
    }
    add_normal(normals, signs, M, k_n);
    const Sym<V> power = symmetric_part(matrix(S) * matrix(sigma));
    work += dot(matrix(power), matrix(M));
    add_normal(normals, signs, power, along);
    flowing += fraction;
    kept.set(my, i, M);
    kept.set(my, i, 6, fraction * norm);
  }

  // of M without what is relieved below
  for (int n = 0; n < 3; ++n) work -= V(8.0f) * k_n[n] * along[n];
  const bool flows = fails == 0 && flowing > 0;
  value[my.brick * kWidth + my.lane] = flows ? float(eighth * volume * work) : 0.0f;
  const bool stays = fails != 0 || !(flowing > 0);
  const float fracture_stress = of_rest(14), fracture_stretch = of_rest(15);
  bool breaks = false;
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    Sym<V> M = kept.symmetric_at(my, i);
    relieve_by(k_n, Signs(i), kept.normals_at(my, i), M);
    const Mat<V> log = matrix(M);
    const Mat<V> change = history_at(before.G, my, i) *
                          exponential_series(scaled(V(-1.0f), log), exponential_terms(dot(log, log), fails));
    Mat<V> G;
    for (int k = 0; k < 9; ++k) {
      const std::size_t entry = place_of_sample(my, 9, k, i);
      const double old = before.G[entry], now = stays ? old : old + change.m[k / 3][k % 3];
      after.G[entry] = now;
      G.m[k / 3][k % 3] = V(static_cast<float>(now));
    }
    if (fracture_stretch < kNoLimit) {  // no singular value of G^-1 is above its norm
      const Mat<V> cof = cofactor(G);
      const float least = kNearLimit * fracture_stretch * abs(dot(G.m[0], cof.m[0]));
      breaks = breaks || !(dot(cof, cof) < least * least);
    }
    const std::size_t sample = place_of_sample(my, 1, 0, i);
    const double tau = before.tau[sample], harder = tau + hardening * kept.number_at(my, i, 6);
    const V mean = V(1.0f / 3) * trace(M);
    const V strain = sqrt(V(2.0f / 3) * squared_norm(Sym<V>{M.xx - mean, M.yy - mean, M.zz - mean, M.yz, M.zx, M.xy}));
    after.tau[sample] = stays ? tau : harder > 0 ? harder : 0;
    breaks = breaks || (harder > tau && harder > fracture_stress);
    after.strain[sample] = before.strain[sample] + (stays ? 0 : strain);
  }
  status[my.brick * kWidth + my.lane] = fails != 0 ? kIsLeft : flows ? breaks ? kFlows | kMayBreak : kFlows : 0;
}

/// The L of B = L L^T, [brick][6][lane]: its lower triangle by columns.
__device__ inline void store_triangle_of(const Mat<V>& B, const Place& my, float* to) {
  const V L00 = sqrt(B(0, 0)), L10 = B(1, 0) / L00, L20 = B(2, 0) / L00;
  const V L11 = sqrt(B(1, 1) - L10 * L10), L21 = (B(2, 1) - L20 * L10) / L11;
  const V L[6] = {L00, L10, L20, L11, L21, sqrt(B(2, 2) - L20 * L20 - L21 * L21)};
  for (int k = 0; k < 6; ++k) to[(my.brick * 6 + k) * kWidth + my.lane] = L[k];
}

/// Gm.                                                                                                        eq. P2
__global__ void __launch_bounds__(kWidth* kBricksOfBlock) find_mean(Layout at, const double* G, float* mean_plastic) {
  const Place my;
  if (my.brick >= at.num_bricks) return;
  Mat<V> B = {};
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    const Mat<V> one = history_at(G, my, i), GG = product_transposed(one, one);
    for (int k = 0; k < 9; ++k) B.m[k / 3][k % 3] += V(0.125f) * GG.m[k / 3][k % 3];
  }
  store_triangle_of(B, my, mean_plastic);
}

}  // namespace hexaplast::one_number
