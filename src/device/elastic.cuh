// SPDX-License-Identifier: LGPL-2.1-or-later
// Forces, coefficients, product, energy and diagonal on a GPU.
#pragma once

#ifdef __CUDACC__
#include <cuda_pipeline.h>
#endif

#include "device/nodes.cuh"
#include "material/law-inl.hpp"

namespace hexaplast::one_number {

/// L p: apply_stiffness (elastic/assumed-inl.hpp), sample by sample. weight: [brick][2][lane], mu and lambda.
__global__ void __launch_bounds__(kWidth* kBricksOfBlock, 8)
    multiply(Layout at, const uint4* coef, const float* weight, Direction d, float4* partial) {
  __shared__ CornerForces f[kBricksOfBlock];
  const Place my;
  if (my.brick >= at.num_bricks) return;
  __shared__ uint4 words[kBricksOfBlock][kWords][kWidth];
  for (int k = 0; k < kWords; ++k)
    __pipeline_memcpy_async(&words[my.here][k][my.lane], coef + (my.brick * kWords + k) * kWidth + my.lane, 16);
  __pipeline_commit();
  const auto word = [&](int k) { return words[my.here][k][my.lane]; };
  CornerLanes<V> u;
  unrolled<8>([&](auto c) __attribute__((always_inline)) {
    const float4 p = direction_at(d, node_of_corner(at, my, c));
    u.at[c][0] = V(p.x), u.at[c][1] = V(p.y), u.at[c][2] = V(p.z);
  });
  __pipeline_wait_prior(0);
  StoredHalf others[kByHexahedron];
  unrolled<kByHexahedron>([&](auto k) __attribute__((always_inline)) { others[k] = half_of(word(9 + k / 8), k % 8); });

  // four times the mean edges and the hourglass modes; samples weigh an eighth each
  const V sixteenth(1.0f / 16), all(128.0f);
  const V mu = sixteenth * of_brick(weight, 2, my, 0), lambda = sixteenth * of_brick(weight, 2, my, 1);
  const V free = free_modulus(mu, lambda);
  ModeLanes<V> modes_of_u;
  modes(u, modes_of_u);
  const Numbers<9> directions{others};
  const Numbers<21> volume_gradient{others + 9}, mean_gradient{others + 30};
  const V along_volume = all * lambda * along_gradient(volume_gradient, modes_of_u);
  const V along_mean = all * -free * along_gradient(mean_gradient, modes_of_u);
  const Mat<V> j = load_mat<V>(directions);
  const AssumedLanes<V> how(j, V(kWeight));
  V a[3][3];
  how.columns(modes_of_u.at + 3, a);
  const uint4 last = word(8);
  ActingModes acting;
  unrolled<8>([&](auto i) __attribute__((always_inline)) {
    const Signs signs(i);
    StoredHalf C[9];
    halves_of_sample(word(i), last, i, C);
    Mat<V> edges, columns;
    columns_at(modes_of_u, a, signs, edges, columns);
    apply_sample(Numbers<9>{C}, mu, free, columns);
    acting.add(columns, signs);
  });
  acting.weigh();
  how.add_transpose(acting.a, acting.on.at + 3);
  add_gradient(along_volume, volume_gradient, acting.on);
  add_gradient(along_mean, mean_gradient, acting.on);
  modes_transpose(acting.on, u);
  add_brick(at, my, u, f[my.here], partial);
}

/// What the samples of a hexahedron follow from.
struct PlacedHexahedron {
  ModeLanes<V> modes;  ///< a quarter of those of the corners: the mean edges and the hourglass modes
  Mat<V> dual;         ///< J^-1 / 2
  Mat<V> j;
  PolarLanes<V> mean;
  V a[3][3];
};
/// u = scale times what the corners are from the first of them, in double precision until they are numbers of a lane.
__device__ inline void gather_about_corner(const Layout& at, const Place& my, const double4_32a* x, double scale,
                                           CornerLanes<V>& u) {
  const double4_32a origin = x[node_of_corner(at, my, 0)];
  unrolled<8>([&](auto c) __attribute__((always_inline)) {
    const double4_32a corner = x[node_of_corner(at, my, c)];
    u.at[c][0] = V(static_cast<float>(scale * (corner.x - origin.x)));
    u.at[c][1] = V(static_cast<float>(scale * (corner.y - origin.y)));
    u.at[c][2] = V(static_cast<float>(scale * (corner.z - origin.z)));
  });
}
/// mean_plastic: [brick][6][lane], the lower triangle of Gm, by columns.                            eq. P2, E10, E11c
__device__ inline void place_hexahedron(const Layout& at, const Place& my, const float* rest, const double4_32a* x,
                                        const float* mean_plastic, PlacedHexahedron& to) {
  CornerLanes<V> u;
  gather_about_corner(at, my, x, 0.25, u);
  modes(u, to.modes);
  Mat<V> edges;
  for (int k = 0; k < 9; ++k) {
    to.dual.m[k / 3][k % 3] = of_brick(rest, kRestNumbers, my, k);
    edges.m[k / 3][k % 3] = to.modes.at[k / 3][k % 3];
  }
  const auto L = [&](int k) { return of_brick(mean_plastic, 6, my, k); };
  const V none(0.0f);
  const Mat<V> Gm = {{{L(0), none, none}, {L(1), L(3), none}, {L(2), L(4), L(5)}}};
  const Mat<V> dual_plastic = to.dual * Gm, F_m = transposed_product(edges, dual_plastic);
  safe_polars<1>(&F_m, &to.mean);
  to.j = product_transposed(dual_plastic, to.mean.R);
  AssumedLanes<V>(to.j, V(kWeight)).columns(to.modes.at + 3, to.a);
}
/// The volume, and what it changes with the modes of the corners.                                             eq. E30
__device__ inline V volume_of_placed(const PlacedHexahedron& h, ModeLanes<V>& gradient) {
  const V volume = V(64.0f) * volume_of(h.modes, gradient);
  for (int k = 0; k < 21; ++k) gradient.at[k / 3][k % 3] *= V(16.0f);
  return volume;
}

constexpr std::uint8_t kThin = 1, kFlows = 2;  ///< bits of the status of a hexahedron, beside kIsLeft and kMayBreak

__device__ inline std::size_t place_of_sample(const Place& my, int count, int k, int i) {
  return ((static_cast<std::size_t>(my.brick) * count + k) * kCorners + i) * kWidth + my.lane;
}
__device__ inline Mat<V> history_at(const double* G, const Place& my, int i) {
  Mat<V> of;
  for (int k = 0; k < 9; ++k) of.m[k / 3][k % 3] = V(static_cast<float>(G[place_of_sample(my, 9, k, i)]));
  return of;
}

/// Forces, coefficients and weights at positions x; length [m]: of an edge, by which coefficients become numbers that a
/// half can be. The pressure of the mean dilatation acts as its gradient does, so that one loop over the samples is
/// enough. status: kThin where det J of a corner is below thin_from of the volume.
///                                                            eq. P1 to P5, E6, E12, E13; elastic/linearize_pass.cpp
__global__ void __launch_bounds__(kWidth* kBricksOfBlock, 4)
    linearize(Layout at, const float* rest, float length, const double4_32a* x, const double* G,
              const float* mean_plastic, uint4* coef, float* weight, float4* partial, float thin_from,
              std::uint8_t* status) {
  __shared__ CornerForces shared[kBricksOfBlock];
  const Place my;
  if (my.brick >= at.num_bricks) return;
  CornerForces& room = shared[my.here];
  PlacedHexahedron h;
  place_hexahedron(at, my, rest, x, mean_plastic, h);
  const auto of_rest = [&](int k) { return of_brick(rest, kRestNumbers, my, k); };
  const V volume = of_rest(9), mu = of_rest(10), lambda = of_rest(11);
  const V free = free_modulus(mu, lambda);
  uint4* const to = coef + static_cast<std::size_t>(my.brick) * kWords * kWidth + my.lane;

  ActingModes acting, dilating;  // stresses without the shared pressure; the gradient of the mean dilatation
  V theta_sum(0.0f), least(1e30f);
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    const Signs signs(i);
    Mat<V> edges, columns;
    columns_at(h.modes, h.a, signs, edges, columns);
    least = min(least, determinant(edges));
    const Mat<V> inverse = h.dual * history_at(G, my, i), F = transposed_product(columns, inverse);
    PolarLanes<V> polar;
    safe_polars<1>(&F, &polar);
    const V theta = dilatation(ElasticLaw::kCorotated, polar.S);
    theta_sum += theta;
    const Mat<V> P = polar.R * matrix(stress(ElasticLaw::kCorotated, 0, polar.S, mu, free * theta));
    const Mat<V> C = product_transposed(inverse, polar.R);
    acting.add(product_transposed(inverse, P), signs);
    dilating.add(C, signs);
    to[i * kWidth] = word_of([&](int k) { return length * C.m[k / 3][k % 3]; });
    room[i][0][my.lane] = length * C(2, 2);
  }
  to[8 * kWidth] = word_of([&](int i) { return room[i][0][my.lane]; });
  const V shared_pressure = V(-0.125f) * free * theta_sum;
  for (int k = 0; k < 21; ++k) acting.on.at[k / 3][k % 3] += shared_pressure * dilating.on.at[k / 3][k % 3];
  for (int k = 0; k < 9; ++k) acting.a[k / 3][k % 3] += shared_pressure * dilating.a[k / 3][k % 3];
  acting.weigh();
  dilating.weigh();

  // what is assumed, and the rotation that it follows
  const AssumedLanes<V> how(h.j, V(kWeight));
  V on_Q[3][3], moment[3] = {V(0.0f), V(0.0f), V(0.0f)};
  for (int k = 0; k < 9; ++k) on_Q[k / 3][k % 3] = V(0.0f);
  how.add_transpose(acting.a, on_Q);
  how.add_transpose(dilating.a, dilating.on.at + 3);
  V Q[3][3];
  for (int k = 0; k < 9; ++k) Q[k / 3][k % 3] = h.modes.at[3 + k / 3][k % 3];
  add_moment(1, h.a, acting.a, moment);
  add_moment(-1, Q, on_Q, moment);
  const Mat<V> turns = turning(h.mean, h.j, moment);
  for (int k = 0; k < 9; ++k) {
    acting.on.at[k / 3][k % 3] += turns.m[k / 3][k % 3];
    acting.on.at[3 + k / 3][k % 3] += on_Q[k / 3][k % 3];
  }

  ModeLanes<V> gradient;
  const V pressure = lambda * (volume_of_placed(h, gradient) / volume - V(1.0f));
  for (int k = 0; k < 21; ++k) {
    V& on = acting.on.at[k / 3][k % 3];
    on = V(-1.0f / 32) * volume * on - pressure * gradient.at[k / 3][k % 3];
  }
  const auto other = [&](int k) {
    if (k < 9) return length * h.j.m[k / 3][k % 3];
    if (k < 30) return V(length) / volume * gradient.at[(k - 9) / 3][k % 3];
    if (k < kByHexahedron) return length / 32 * dilating.on.at[(k - 30) / 3][k % 3];
    return 0.0f;
  };
  unrolled<7>([&](auto w) __attribute__((always_inline)) {
    to[(9 + w) * kWidth] = word_of([&](int k) { return other(8 * w + k); });
  });
  const float per_sample = volume / (8 * length * length);
  status[my.brick * kWidth + my.lane] = least < V(thin_from) * volume ? kThin : 0;
  weight[my.brick * 2 * kWidth + my.lane] = per_sample * mu;
  weight[(my.brick * 2 + 1) * kWidth + my.lane] = per_sample * lambda;
  CornerLanes<V> f;
  modes_transpose(acting.on, f);
  __syncwarp();
  add_brick(at, my, f, room, partial);
}

/// value: elastic energy [J] at positions x; status: as of linearize. eq. 18, E5, P17
__global__ void __launch_bounds__(kWidth* kBricksOfBlock, 6)
    energy(Layout at, const float* rest, const double4_32a* x, const double* G, const float* mean_plastic, float* value,
           float thin_from, std::uint8_t* status) {
  const Place my;
  if (my.brick >= at.num_bricks) return;
  PlacedHexahedron h;
  place_hexahedron(at, my, rest, x, mean_plastic, h);
  const auto of_rest = [&](int k) { return of_brick(rest, kRestNumbers, my, k); };
  const V volume = of_rest(9), mu = of_rest(10), lambda = of_rest(11), half(0.5f), eighth(0.125f);
  const V free = free_modulus(mu, lambda);
  V sum(0.0f), theta_sum(0.0f), least(1e30f);
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    Mat<V> edges, columns;
    columns_at(h.modes, h.a, Signs(i), edges, columns);
    least = min(least, determinant(edges));
    const Mat<V> F = transposed_product(columns, h.dual * history_at(G, my, i));
    PolarLanes<V> polar;
    safe_polars<1>(&F, &polar);
    const V theta = dilatation(ElasticLaw::kCorotated, polar.S);
    theta_sum += theta;
    sum += shape_energy(ElasticLaw::kCorotated, 0, polar.S, mu) + half * free * theta * theta;
  }
  status[my.brick * kWidth + my.lane] = least < V(thin_from) * volume ? kThin : 0;
  ModeLanes<V> gradient;
  const V mean = eighth * theta_sum, excess = volume_of_placed(h, gradient) / volume - V(1.0f);
  value[my.brick * kWidth + my.lane] = volume * (eighth * sum + half * (lambda * excess * excess - free * mean * mean));
}

/// add(a, r) for the corners a: r is what C makes of the columns of sample i that a unit of a corner is. weight: of the
/// corner of the sample in its columns.
template <class Add>
__device__ void visit_corners(const uint4& first, const uint4& last, int i, float weight, const Add& add) {
  StoredHalf halves[9];
  halves_of_sample(first, last, i, halves);
  V C[9];
  unrolled<9>([&](auto k) __attribute__((always_inline)) { C[k] = load_as(halves + k); });
  const Signs of_sample(i);
  unrolled<8>([&](auto a) __attribute__((always_inline)) {
    const Signs of_corner(a);
    V r[3] = {V(0.0f), V(0.0f), V(0.0f)};
    unrolled<3>([&](auto d) __attribute__((always_inline)) {
      constexpr int m = d == 0 ? 1 : 0, l = d == 2 ? 1 : 2;
      const V same = V(0.25f) * (V(1.0f) + of_corner.at[m] * of_sample.at[m]) *
                     (V(1.0f) + of_corner.at[l] * of_sample.at[l]);  // 1: an edge at the corner of the sample
      const V along = of_corner.at[d] * (V((1 - weight) / 4) + V(weight) * same);
      for (int c = 0; c < 3; ++c) r[c] += along * C[3 * d + c];
    });
    add(a, r);
  });
}

/// Sums at the nodes of a brick of the diagonal of L; what is assumed is left out.                     eq. 17, E4, E7
__global__ void __launch_bounds__(kWidth* kBricksOfBlock)
    diagonal(Layout at, const uint4* coef, const float* weight, float4* partial) {
  __shared__ CornerForces shared[kBricksOfBlock];
  const Place my;
  if (my.brick >= at.num_bricks) return;
  const auto word = [&](int k) { return coef[(static_cast<std::size_t>(my.brick) * kWords + k) * kWidth + my.lane]; };
  const V mu = of_brick(weight, 2, my, 0), lambda = of_brick(weight, 2, my, 1), free = free_modulus(mu, lambda);
  CornerLanes<V> sum, mean;
  set_zero(sum);
  set_zero(mean);
  const uint4 last = word(8);
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i)
    visit_corners(
        word(i), last, i, kWeight, [&](auto a, const V(&r)[3]) __attribute__((always_inline)) {
          const V squared = mu * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
          for (int c = 0; c < 3; ++c) {
            sum.at[a][c] += squared + (mu + free) * r[c] * r[c];
            mean.at[a][c] += r[c];
          }
        });
  StoredHalf volume_gradient[21];
  unrolled<21>([&](auto k) __attribute__((always_inline)) {
    volume_gradient[k] = half_of(word(9 + (9 + k) / 8), (9 + k) % 8);
  });
  ModeLanes<V> along;
  set_zero(along);
  add_gradient(V(1.0f), Numbers<21>{volume_gradient}, along);
  CornerLanes<V> b;
  modes_transpose(along, b);
  for (int k = 0; k < 3 * kCorners; ++k) {
    const V m = mean.at[k / 3][k % 3], of_volume = b.at[k / 3][k % 3];
    sum.at[k / 3][k % 3] += V(8.0f) * lambda * of_volume * of_volume - V(0.125f) * free * m * m;
  }
  add_brick(at, my, sum, shared[my.here], partial);
}

}  // namespace hexaplast::one_number
