// SPDX-License-Identifier: LGPL-2.1-or-later
// Kernels of the default element with isolated rest shapes for a GPU: parallelepipeds, mixed precision. A warp has a
// brick of 32 hexahedra, a lane has one of them with all of its samples. Arrays of bricks end in [lane]: neighbouring
// lanes read neighbouring numbers. Corners and samples are in the order of kCornerSign.   theory.md sections 2.1, 5.9
#pragma once

#define HEXAPLAST_ONE_NUMBER

#include <cstdint>
#ifdef __CUDACC__
#include <cuda_pipeline.h>
#endif

#include "device/device_kernels.hpp"
#include "device/runtime.hpp"
#include "elastic/assumed-inl.hpp"
#include "element/isolated-inl.hpp"
#include "material/law-inl.hpp"
#include "plastic/point_flow-inl.hpp"

namespace hexaplast::one_number {

using V = float;

constexpr int kWidth = kBrick;       ///< hexahedra of a brick
constexpr int kBricksOfBlock = 2;    ///< a warp each
constexpr int kNodes = kBrickNodes;  ///< room for the nodes of a brick
constexpr int kRestNumbers = kBrickNumbers;
constexpr int kByHexahedron = 51;  ///< coefficients: j, gradients of the volume and of the mean dilatation
constexpr float kWeight = 0.57735026918962576451f;  // Sampling::corner_weight

/// Where corners and nodes are. A brick adds the corners of each of its nodes, a node adds its bricks: sums have one
/// order, and need no atomics.
struct Layout {
  int num_bricks, num_nodes;
  const std::uint8_t* local;     ///< [brick][corner][lane]: number of the node in the brick
  const std::uint8_t* sorted;    ///< [brick][corner kWidth + lane]: corners by node, ascending
  const std::uint16_t* begin;    ///< [brick][kNodes + 1]: where those of a node begin
  const int* node;               ///< [brick][kNodes], or -1
  const int* partial_begin;      ///< [node + 1]
  const int* partial;            ///< places [brick][kNodes] of the sums of a node, in the order of bricks
  const std::uint32_t* present;  ///< [brick]: a bit per hexahedron that is there
};

struct Place {
  __device__ Place()
      : lane(threadIdx.x % kWidth), here(threadIdx.x / kWidth), brick(blockIdx.x * kBricksOfBlock + here) {}
  int lane, here, brick;
};
/// Number k of `count` of each hexahedron.
__device__ inline V of_brick(const float* from, int count, const Place& my, int k) {
  return V(from[(my.brick * count + k) * kWidth + my.lane]);
}
__device__ inline int node_of_corner(const Layout& at, const Place& my, int c) {
  return at.node[my.brick * kNodes + at.local[(my.brick * kCorners + c) * kWidth + my.lane]];
}

/// [corner][component][lane]
using CornerForces = float[kCorners][3][kWidth];
/// Forces of the corners become sums of the brick, [brick][kNodes].
__device__ inline void add_brick(const Layout& at, const Place& my, const CornerLanes<V>& of_corner, CornerForces& f,
                                 float4* partial) {
  for (int corner = 0; corner < kCorners; ++corner)
    for (int c = 0; c < 3; ++c) f[corner][c][my.lane] = of_corner.at[corner][c];
  __syncwarp();
  const std::uint16_t* const begin = at.begin + my.brick * (kNodes + 1);
  for (int t = my.lane; t < kNodes; t += kWidth) {
    float sum[3] = {0, 0, 0};
    for (int k = begin[t]; k < begin[t + 1]; ++k) {
      const int corner = at.sorted[my.brick * kCorners * kWidth + k];
      for (int c = 0; c < 3; ++c) sum[c] += f[corner / kWidth][c][corner % kWidth];
    }
    partial[my.brick * kNodes + t] = make_float4(sum[0], sum[1], sum[2], 0);
  }
}

// Samples, one after the other: what columns_of_modes and modes_of_columns (kinematics/columns-inl.hpp) do for all.

/// s_n of a corner or sample.
struct Signs {
  __device__ explicit Signs(int i) : at{one(i ^ i >> 1), one(i >> 1), one(i >> 2)} {}
  static __device__ V one(int bit) { return V(bit & 1 ? 1.0f : -1.0f); }
  V at[3];
};
/// Rows: the edges at the corner, and the columns of the sample.                                             eq. E11c
__device__ inline void columns_at(const ModeLanes<V>& modes, const V (&a)[3][3], const Signs& s, Mat<V>& edges,
                                  Mat<V>& columns) {
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    constexpr int m = n == 0 ? 1 : 0, l = n == 2 ? 1 : 2;
    for (int c = 0; c < 3; ++c) {
      const V bend = s.at[m] * modes.at[3 + l][c] + s.at[l] * (modes.at[3 + m][c] + s.at[m] * modes.at[6][c]);
      edges(n, c) = modes.at[n][c] + bend;
      columns(n, c) = modes.at[n][c] + V(kWeight) * bend + s.at[n] * a[n][c];
    }
  });
}
/// Those of a child of a cell: the edges at its corner and the mean ones in equal parts.
constexpr float kCellWeight = 0.5f;
__device__ inline void columns_of_cell(const ModeLanes<V>& modes, const Signs& s, Mat<V>& columns) {
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    constexpr int m = n == 0 ? 1 : 0, l = n == 2 ? 1 : 2;
    for (int c = 0; c < 3; ++c)
      columns(n, c) = modes.at[n][c] + V(kCellWeight) * (s.at[m] * modes.at[3 + l][c] +
                                                         s.at[l] * (modes.at[3 + m][c] + s.at[m] * modes.at[6][c]));
  });
}
/// What rows that act on columns act with: on the modes, and on what is assumed.
struct ActingModes {
  __device__ ActingModes() {
    set_zero(on);
    for (int k = 0; k < 9; ++k) a[k / 3][k % 3] = V(0.0f);
  }
  __device__ void add(const Mat<V>& rows, const Signs& s) {
    unrolled<3>([&](auto n) __attribute__((always_inline)) {
      constexpr int m = n == 0 ? 1 : 0, l = n == 2 ? 1 : 2;
      for (int c = 0; c < 3; ++c) {
        const V row = rows(n, c), far = s.at[m] * row;
        on.at[n][c] += row;
        on.at[3 + l][c] += far;
        on.at[3 + m][c] += s.at[l] * row;
        on.at[6][c] += s.at[l] * far;
        a[n][c] += s.at[n] * row;
      }
    });
  }
  /// To be called once, when all samples are in. weight: of the corner in their columns.
  __device__ void weigh(float weight = kWeight) {
    for (int k = 9; k < 21; ++k) on.at[k / 3][k % 3] *= V(weight);
  }
  ModeLanes<V> on;
  V a[3][3];
};

// Coefficients in words of 16 bytes, [brick][word][lane]: word i has the first eight numbers of C_i, word 8 the last
// ones of all, and the others j, the gradient of the volume and that of the mean dilatation.

constexpr int kWords = 16;
template <int kCount>
using Numbers = StoredNumbers<kCount, 1, const StoredHalf>;  ///< of one hexahedron, in registers

HEXAPLAST_INLINE StoredHalf half_of(const uint4& word, int k) {
  const unsigned bits = k < 4 ? k < 2 ? word.x : word.y : k < 6 ? word.z : word.w;
  return {static_cast<std::uint16_t>(bits >> 16 * (k % 2))};
}
HEXAPLAST_INLINE unsigned half_bits(float a) {
  StoredHalf half;
  store_as(a, &half);
  return half.bits;
}
/// of(0) ... of(7)
template <class Of>
__device__ uint4 word_of(const Of& of) {
  const auto two = [&](int k) { return half_bits(of(k)) | half_bits(of(k + 1)) << 16; };
  return {two(0), two(2), two(4), two(6)};
}

/// A number that the host knows, or that lies on the device.
struct Factor {
  double value;
  const double* place;  ///< null: the value
};
__device__ inline float factor(const Factor& a) { return static_cast<float>(a.place ? *a.place : a.value); }

/// f(axis 0 of all), ... of vectors at a node.
template <class F, class... Vectors>
__device__ inline void for_each_axis(const F& f, Vectors&... at) {
  f(at.x...);
  f(at.y...);
  f(at.z...);
}

template <class F>
__device__ inline void for_each_axis_of(const float (&numbers)[3], const F& f, float4& at) {
  f(numbers[0], at.x);
  f(numbers[1], at.y);
  f(numbers[2], at.z);
}

/// Blocks of nodes; of_node null: none.
struct Blocks {
  const int* of_node;  ///< or -1
  const BlockEntry* entries;
  __device__ const BlockEntry* at(int n) const { return of_node && of_node[n] >= 0 ? entries + of_node[n] : nullptr; }
};
/// to += factor left diag(scale) right^T a
__device__ inline void add_along(float factor, const float (&left)[9], const float (&scale)[3], const float (&right)[9],
                                 const float4& a, float4& to) {
  for (int k = 0; k < 3; ++k) {
    const float along = factor * scale[k] * (right[k] * a.x + right[3 + k] * a.y + right[6 + k] * a.z);
    to.x += left[k] * along, to.y += left[3 + k] * along, to.z += left[6 + k] * along;
  }
}
/// D^-1 r, of D and the block of node n; rigid directions with the others or left out.
__device__ inline float4 divided(const Blocks& blocks, int n, float4 inverse, float4 r, bool with_rigid) {
  float4 z = make_float4(inverse.x * r.x, inverse.y * r.y, inverse.z * r.z, 0);
  if (const BlockEntry* block = blocks.at(n)) {
    z.x *= block->alone[0], z.y *= block->alone[1], z.z *= block->alone[2];
    add_along(1, block->axes, block->inverse, block->axes, r, z);
    if (with_rigid) add_along(1, block->axes, block->rigid, block->axes, r, z);
  }
  return z;
}

/// Direction of conjugate gradients at a node: z + beta p.
struct Direction {
  const float4 *p, *r;    ///< r null: p alone
  const float4* inverse;  ///< z = inverse r, with blocks; null: r
  Blocks blocks;
  Factor beta;
};
__device__ inline float4 direction_at(const Direction& d, int n) {
  const float4 p = d.p[n];
  if (!d.r) return p;
  const float4 z = d.inverse ? divided(d.blocks, n, d.inverse[n], d.r[n], true) : d.r[n];
  const float beta = factor(d.beta);
  return make_float4(z.x + beta * p.x, z.y + beta * p.y, z.z + beta * p.z, 0);
}

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
    const uint4 first = word(i);
    StoredHalf C[9];
    for (int k = 0; k < 8; ++k) C[k] = half_of(first, k);
    C[8] = half_of(last, i);
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

constexpr std::uint8_t kThin = 1, kLeft = 1, kFlows = 2;  ///< bits of the status of a hexahedron

/// History of samples: G (9), tau [Pa], accumulated strain [-], each [brick][number][sample][lane].
template <class N>
struct Plastic {
  N *G, *tau, *strain;
};
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

struct FlowRule {
  float dt;                                     ///< [s]
  float least_det = 0.1f, least_corner = 0.3f;  ///< below these a hexahedron is left over
  bool is_true_stress = true;                   ///< YieldStressMeasure::kCauchy
};

/// History after a step at positions x. status: kLeft where a hexahedron is for the CPU, and keeps its history;
/// kFlows. value: what it dissipates [J]. Three loops over samples find the stretches, what flows, and the new history.
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
  status[my.brick * kWidth + my.lane] = fails != 0 ? kLeft : flows ? kFlows : 0;
  value[my.brick * kWidth + my.lane] = flows ? float(eighth * volume * work) : 0.0f;
  const bool stays = fails != 0 || !(flowing > 0);
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    Sym<V> M = kept.symmetric_at(my, i);
    relieve_by(k_n, Signs(i), kept.normals_at(my, i), M);
    const Mat<V> log = matrix(M);
    const Mat<V> change = history_at(before.G, my, i) *
                          exponential_series(scaled(V(-1.0f), log), exponential_terms(dot(log, log), fails));
    for (int k = 0; k < 9; ++k) {
      const std::size_t entry = place_of_sample(my, 9, k, i);
      const double old = before.G[entry], now = stays ? old : old + change.m[k / 3][k % 3];
      after.G[entry] = now;
    }
    const std::size_t sample = place_of_sample(my, 1, 0, i);
    const double tau = before.tau[sample], harder = tau + hardening * kept.number_at(my, i, 6);
    const V mean = V(1.0f / 3) * trace(M);
    const V strain = sqrt(V(2.0f / 3) * squared_norm(Sym<V>{M.xx - mean, M.yy - mean, M.zz - mean, M.yz, M.zx, M.xy}));
    after.tau[sample] = stays ? tau : harder > 0 ? harder : 0;
    after.strain[sample] = before.strain[sample] + (stays ? 0 : strain);
  }
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
  V C[9];
  unrolled<8>([&](auto k) __attribute__((always_inline)) {
    const StoredHalf half = half_of(first, k);
    C[k] = load_as(&half);
  });
  const StoredHalf half = half_of(last, i);
  C[8] = load_as(&half);
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

// Nodes, and sums over all: numbers of a block, which the last block to finish adds in order.

constexpr int kNodesOfBlock = 256;

__device__ inline float4 sum_of_bricks(const Layout& at, const float4* partial, int n) {
  float4 sum = make_float4(0, 0, 0, 0);
  for (int k = at.partial_begin[n]; k < at.partial_begin[n + 1]; ++k) {
    const float4 part = partial[at.partial[k]];
    sum.x += part.x, sum.y += part.y, sum.z += part.z;
  }
  return sum;
}
/// to = factor times the sums of the bricks.
__global__ void __launch_bounds__(kNodesOfBlock) gather(Layout at, const float4* partial, float factor, float4* to) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n >= at.num_nodes) return;
  const float4 sum = sum_of_bricks(at, partial, n);
  to[n] = make_float4(factor * sum.x, factor * sum.y, factor * sum.z, 0);
}

/// What acts at the nodes of a system A = factor L + diagonal, and its preconditioner.
struct NodalSystem {
  float factor;
  const float4* diagonal;
  const float4* inverse;  ///< of the preconditioner, 0 where fixed; null: 1
  const float4* others;   ///< what other terms make of the direction; null: nothing
  const int* row;         ///< of a node in of_rows, or -1; null: none
  const float4* of_rows;  ///< of multiply_terms
};
struct Scalars {
  double alpha, beta;
  double p_Ap, rr, rz;
  double sum[3];  ///< of hexahedra
  unsigned finished;
};

/// The sums of all blocks; true in one thread of the grid.
template <int kCount>
__device__ inline bool sum_of_blocks(const double (&mine)[kCount], double* block_sum, Scalars* scalars,
                                     double (&total)[kCount]) {
  __shared__ double part[kCount][kNodesOfBlock];
  __shared__ bool is_last;
  const int t = threadIdx.x;
  const auto tree = [&] {
    for (int half = kNodesOfBlock / 2; half > 0; half /= 2) {
      __syncthreads();
      if (t < half)
        for (int c = 0; c < kCount; ++c) part[c][t] += part[c][t + half];
    }
    __syncthreads();
  };
  for (int c = 0; c < kCount; ++c) part[c][t] = mine[c];
  tree();
  if (t == 0) {
    for (int c = 0; c < kCount; ++c) block_sum[kCount * blockIdx.x + c] = part[c][0];
    __threadfence();
    is_last = atomicInc(&scalars->finished, gridDim.x - 1) == gridDim.x - 1;
  }
  __syncthreads();
  if (!is_last) return false;
  __threadfence();
  for (int c = 0; c < kCount; ++c) {
    part[c][t] = 0;
    for (unsigned k = t; k < gridDim.x; k += kNodesOfBlock) part[c][t] += __ldcg(block_sum + kCount * k + c);
  }
  tree();
  for (int c = 0; c < kCount; ++c) total[c] = part[c][0];
  return t == 0;
}
__device__ inline double dot(const float4& a, const float4& b) {
  return double(a.x) * b.x + double(a.y) * b.y + double(a.z) * b.z;
}

constexpr float kFixed = 1e38f;  ///< of a node that does not move: what else acts on it

/// inverse = 1 / (factor diag(L) + rest), or 1; 0 where rest is kFixed or more, and there alone: next to nothing where
/// nothing is. partial: of the diagonal, or null. scalars->sum: DeviceKernels::Stiffness.
__global__ void __launch_bounds__(kNodesOfBlock)
    invert(Layout at, const float4* partial, float factor, const float4* rest, float break_even, float4* inverse,
           double* block_sum, Scalars* scalars) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  double mine[3] = {0, 0, 0}, total[3];
  if (n < at.num_nodes) {
    const float4 sum = partial ? sum_of_bricks(at, partial, n) : make_float4(0, 0, 0, 0), more = rest[n];
    const auto one = [&](float stiffness, float other) {
      mine[0] += factor * stiffness;
      if (!(other < kFixed)) return 0.0f;
      mine[1] += factor * stiffness;
      if (factor * stiffness > break_even * other) mine[2] += factor * stiffness;
      const float entry = factor * stiffness + other;
      return partial ? entry > 0 ? 1 / entry : 1e-30f : 1.0f;
    };
    inverse[n] = make_float4(one(sum.x, more.x), one(sum.y, more.y), one(sum.z, more.z), 0);
  }
  if (sum_of_blocks(mine, block_sum, scalars, total))
    for (int c = 0; c < 3; ++c) scalars->sum[c] = total[c];
}

/// scalars->sum: of the hexahedra that are there, their values, and how many have the first and the second bit of their
/// status. value, status: [brick][lane], or null.
__global__ void __launch_bounds__(kNodesOfBlock)
    sum_hexahedra(Layout at, const float* value, const std::uint8_t* status, double* block_sum, Scalars* scalars) {
  const int e = blockIdx.x * kNodesOfBlock + threadIdx.x;
  double mine[3] = {0, 0, 0}, total[3];
  if (e < at.num_bricks * kWidth && (at.present[e / kWidth] >> e % kWidth & 1)) {
    if (value) mine[0] = value[e];
    if (status) mine[1] = status[e] & 1, mine[2] = status[e] >> 1 & 1;
  }
  if (sum_of_blocks(mine, block_sum, scalars, total))
    for (int c = 0; c < 3; ++c) scalars->sum[c] = total[c];
}

/// Ap = A p with the new p, which it writes; alpha.
__global__ void __launch_bounds__(kNodesOfBlock)
    sum_nodes(Layout at, NodalSystem system, const float4* partial, Direction d, float4* p, float4* Ap,
              double* block_sum, Scalars* scalars) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  double mine[1] = {0}, total[1];
  if (n < at.num_nodes) {
    const float4 here = direction_at(d, n), m = system.diagonal[n];
    float4 sum = sum_of_bricks(at, partial, n);
    sum.x = m.x * here.x + system.factor * sum.x;
    sum.y = m.y * here.y + system.factor * sum.y;
    sum.z = m.z * here.z + system.factor * sum.z;
    const auto add = [&](const float4& more) { sum.x += more.x, sum.y += more.y, sum.z += more.z; };
    if (system.others) add(system.others[n]);
    if (system.row && system.row[n] >= 0) add(system.of_rows[system.row[n]]);
    if (system.inverse) {
      const float4 inverse = system.inverse[n];
      if (inverse.x == 0) sum.x = 0;
      if (inverse.y == 0) sum.y = 0;
      if (inverse.z == 0) sum.z = 0;
    }
    p[n] = here;
    Ap[n] = sum;
    mine[0] = dot(here, sum);
  }
  if (sum_of_blocks(mine, block_sum, scalars, total)) {
    scalars->p_Ap = total[0];
    scalars->alpha = scalars->rz / total[0];
  }
}

/// What terms beside the body make of the direction, in double precision: they may be much stiffer than it.
struct Terms {
  int num_rows;
  const int *first, *column;
  const double* block;  ///< nine numbers by rows
};
__global__ void __launch_bounds__(kNodesOfBlock) multiply_terms(Terms terms, Direction d, float4* of_rows) {
  const int row = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (row >= terms.num_rows) return;
  double sum[3] = {0, 0, 0};
  for (int k = terms.first[row]; k < terms.first[row + 1]; ++k) {
    const float4 p = direction_at(d, terms.column[k]);
    const double* const block = terms.block + 9 * static_cast<std::size_t>(k);
    for (int c = 0; c < 3; ++c) sum[c] += block[3 * c] * p.x + block[3 * c + 1] * p.y + block[3 * c + 2] * p.z;
  }
  of_rows[row] = make_float4(float(sum[0]), float(sum[1]), float(sum[2]), 0);
}

/// p alone, for terms that the host adds.
__global__ void __launch_bounds__(kNodesOfBlock) set_direction(int num_nodes, Direction d, float4* p) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n < num_nodes) p[n] = direction_at(d, n);
}

/// x += alpha p, r -= alpha Ap; beta. inverse: as of NodalSystem.
__global__ void __launch_bounds__(kNodesOfBlock)
    update(int num_nodes, const float4* inverse, Blocks blocks, Factor step, const float4* p, const float4* Ap,
           float4* x, float4* r, double* block_sum, Scalars* scalars) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  const float alpha = factor(step);
  double mine[2] = {0, 0}, total[2];
  if (n < num_nodes) {
    const float4 along = p[n], A = Ap[n], at = x[n], old = r[n];
    const float4 left = make_float4(old.x - alpha * A.x, old.y - alpha * A.y, old.z - alpha * A.z, 0);
    x[n] = make_float4(at.x + alpha * along.x, at.y + alpha * along.y, at.z + alpha * along.z, 0);
    r[n] = left;
    mine[0] = mine[1] = dot(left, left);
    if (inverse) mine[1] = dot(left, divided(blocks, n, inverse[n], left, true));
  }
  if (sum_of_blocks(mine, block_sum, scalars, total)) {
    scalars->beta = total[1] / scalars->rz;
    scalars->rr = total[0];
    scalars->rz = total[1];
  }
}

}  // namespace hexaplast::one_number
