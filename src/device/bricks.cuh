// SPDX-License-Identifier: LGPL-2.1-or-later
// The default element with isolated rest shapes on a GPU: parallelepipeds, mixed precision. A warp has a brick of 32
// hexahedra, a lane has one of them with all of its samples. Arrays of bricks end in [lane]: neighbouring lanes read
// neighbouring numbers. Corners and samples are in the order of kCornerSign.              theory.md sections 2.1, 5.9
#pragma once

#define HEXAPLAST_ONE_NUMBER

#include <cstdint>

#include "device/device_kernels.hpp"
#include "device/runtime.hpp"
#include "elastic/assumed-inl.hpp"

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
/// C_i, of word i and word 8.
HEXAPLAST_INLINE void halves_of_sample(const uint4& first, const uint4& last, int i, StoredHalf (&C)[9]) {
  for (int k = 0; k < 8; ++k) C[k] = half_of(first, k);
  C[8] = half_of(last, i);
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

}  // namespace hexaplast::one_number
