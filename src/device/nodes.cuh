// SPDX-License-Identifier: LGPL-2.1-or-later
// Kernels of nodes on a GPU: vectors of conjugate gradients, and sums over all.
#pragma once

#include "device/bricks.cuh"

namespace hexaplast::one_number {

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
