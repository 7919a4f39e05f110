// SPDX-License-Identifier: LGPL-2.1-or-later
// Kernels of a multigrid cycle on a GPU: the cells of its coarse meshes, and what its steps do at nodes. A cell is a
// parallelepiped whose eight samples stand for its eight children.                              theory.md section 9.5
#pragma once

#include "device/plastic.cuh"

namespace hexaplast::one_number {

constexpr int kCellWords = 9;  ///< of coefficients, [brick][word][lane]: those of the samples in kWords

/// Sparse rows: to[row] = sum of weight[k] from[column[k]].
struct Map {
  int num_rows;
  const int *first, *column;
  const float* weight;
};

__device__ inline Mat<V> triangle(const float* from, std::size_t place) {
  const auto L = [&](int k) { return V(from[(place / kWidth * 6 + k) * kWidth + place % kWidth]); };
  const V none(0.0f);
  return {{{L(0), none, none}, {L(1), L(3), none}, {L(2), L(4), L(5)}}};
}

/// Coefficients of cells at positions x [m], and the mean of the Gm of their children, by mu, as find_mean leaves it.
/// rest, moduli, child: LevelArrays. mean_of_finer: as of find_mean.                                          eq. P2
__global__ void __launch_bounds__(kWidth* kBricksOfBlock)
    linearize_cells(Layout at, const float* rest, const float* moduli, const int* child, float length,
                    const double4_32a* x, const float* mean_of_finer, uint4* coef, float* mean) {
  __shared__ float last[kBricksOfBlock][kCorners][kWidth];
  const Place my;
  if (my.brick >= at.num_bricks) return;
  CornerLanes<V> u;
  gather_about_corner(at, my, x, 0.25 / length, u);
  ModeLanes<V> current;
  modes(u, current);
  Mat<V> dual, B = {};
  for (int k = 0; k < 9; ++k) dual.m[k / 3][k % 3] = of_brick(rest, 9, my, k);
  uint4* const to = coef + static_cast<std::size_t>(my.brick) * kCellWords * kWidth + my.lane;
  V sum(0.0f);
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    const int place = child[(my.brick * kCorners + i) * kWidth + my.lane];
    const V mu = of_brick(moduli, 2 * kCorners, my, 2 * i);
    Mat<V> inverse = dual, columns;
    if (place >= 0 && mu > 0) {
      const Mat<V> Gm = triangle(mean_of_finer, place), both = product_transposed(Gm, Gm);
      inverse = dual * Gm;
      sum += mu;
      for (int k = 0; k < 9; ++k) B.m[k / 3][k % 3] += mu * both.m[k / 3][k % 3];
    }
    columns_of_cell(current, Signs(i), columns);
    const Mat<V> F = transposed_product(columns, inverse);
    PolarLanes<V> polar;
    safe_polars<1>(&F, &polar);
    const Mat<V> C = product_transposed(inverse, polar.R);
    to[i * kWidth] = word_of([&](int k) { return C.m[k / 3][k % 3]; });
    last[my.here][i][my.lane] = C(2, 2);
  }
  to[8 * kWidth] = word_of([&](int i) { return last[my.here][i][my.lane]; });
  for (int k = 0; k < 9; ++k) {
    V& entry = B.m[k / 3][k % 3];
    entry = sum > 0 ? entry / sum : V(k % 4 == 0 ? 1.0f : 0.0f);
  }
  store_triangle_of(B, my, mean);
}

/// Sums at the nodes of a brick of L p; coef, moduli: of linearize_cells.
__global__ void __launch_bounds__(kWidth* kBricksOfBlock)
    multiply_cells(Layout at, const uint4* coef, const float* moduli, const float4* p, float4* partial) {
  __shared__ CornerForces f[kBricksOfBlock];
  const Place my;
  if (my.brick >= at.num_bricks) return;
  const auto word = [&](int k) { return coef[(my.brick * kCellWords + k) * kWidth + my.lane]; };
  CornerLanes<V> u;
  unrolled<8>([&](auto c) __attribute__((always_inline)) {
    const float4 of_node = p[node_of_corner(at, my, c)];
    u.at[c][0] = V(of_node.x), u.at[c][1] = V(of_node.y), u.at[c][2] = V(of_node.z);
  });
  ModeLanes<V> modes_of_u;  // four times the mean edges and the hourglass modes
  modes(u, modes_of_u);
  const V sixteenth(1.0f / 16);
  const uint4 last = word(8);
  ActingModes acting;
  unrolled<8>([&](auto i) __attribute__((always_inline)) {
    const Signs signs(i);
    StoredHalf C[9];
    halves_of_sample(word(i), last, i, C);
    Mat<V> columns;
    columns_of_cell(modes_of_u, signs, columns);
    apply_sample(Numbers<9>{C}, sixteenth * of_brick(moduli, 2 * kCorners, my, 2 * i),
                 sixteenth * of_brick(moduli, 2 * kCorners, my, 2 * i + 1), columns);
    acting.add(columns, signs);
  });
  acting.weigh(kCellWeight);
  modes_transpose(acting.on, u);
  add_brick(at, my, u, f[my.here], partial);
}

/// Sums at the nodes of a brick of the diagonal of L.
__global__ void __launch_bounds__(kWidth* kBricksOfBlock)
    diagonal_of_cells(Layout at, const uint4* coef, const float* moduli, float4* partial) {
  __shared__ CornerForces shared[kBricksOfBlock];
  const Place my;
  if (my.brick >= at.num_bricks) return;
  const auto word = [&](int k) { return coef[(my.brick * kCellWords + k) * kWidth + my.lane]; };
  CornerLanes<V> sum;
  set_zero(sum);
  const uint4 last = word(8);
#pragma unroll 1
  for (int i = 0; i < kCorners; ++i) {
    const V mu = of_brick(moduli, 2 * kCorners, my, 2 * i), lambda = of_brick(moduli, 2 * kCorners, my, 2 * i + 1);
    visit_corners(
        word(i), last, i, kCellWeight, [&](auto a, const V(&r)[3]) __attribute__((always_inline)) {
          const V squared = mu * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
          for (int c = 0; c < 3; ++c) sum.at[a][c] += squared + (mu + lambda) * r[c] * r[c];
        });
  }
  add_brick(at, my, sum, shared[my.here], partial);
}

/// Positions of the nodes of a coarse mesh from those of the finer one.
__global__ void __launch_bounds__(kNodesOfBlock) place_nodes(Map placement, const double4_32a* finer, double4_32a* x) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n >= placement.num_rows) return;
  double4_32a sum = {0, 0, 0, 0};
  for (int k = placement.first[n]; k < placement.first[n + 1]; ++k) {
    const double4_32a from = finer[placement.column[k]];
    const double weight = placement.weight[k];
    sum.x += weight * from.x, sum.y += weight * from.y, sum.z += weight * from.z;
  }
  x[n] = sum;
}

// At nodes. A mesh has A = D + factor L at what moves.

struct LevelNodes {
  int num_nodes;
  float factor;
  const float4* diagonal;  ///< D
  const float4* inverse;   ///< 1 / (D + diag(factor L)); 0 where that is not positive
  const float4* follow;    ///< part of what the coarse mesh does that a node does; 0 where fixed
  Blocks blocks;           ///< of the finest mesh
  float4 *x, *r, *d;
};

/// Of the finest mesh, whose nodes have a mass, and what else acts on them: a node follows the coarse mesh as far as
/// this lets it. partial: of the diagonal of L. rest: mass and all else, kFixed where
/// fixed; without has_others the mass alone.
__global__ void __launch_bounds__(kNodesOfBlock)
    set_finest(Layout at, const float4* partial, float factor, const float4* mass, const float4* rest, bool has_others,
               Blocks blocks, float4* diagonal, float4* inverse, float4* follow) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n >= at.num_nodes) return;
  float4 stiffness = sum_of_bricks(at, partial, n), m = mass[n], all = rest[n], D, inverted, part;
  for_each_axis(
      [&](float of_L, float of_mass, float with_others, float& to_D, float& to_inverse, float& to_part) {
        const bool is_fixed = !(with_others < kFixed);
        to_D = is_fixed || !has_others ? of_mass : with_others;
        const float own = factor * of_L + of_mass, sum = factor * of_L + to_D;
        to_inverse = sum > 0 ? 1 / sum : 0;
        to_part = is_fixed ? 0 : to_D > of_mass && own > 0 ? own / sum : 1;
      },
      stiffness, m, all, D, inverted, part);
  if (const BlockEntry* block = blocks.at(n))  // by which such axes follow
    for_each_axis_of(
        block->alone, [](float alone, float& to) { to = alone == 0 ? 1 : to; }, part);
  diagonal[n] = D, inverse[n] = inverted, follow[n] = part;
}

/// diag(factor L) + rest at some nodes.
__global__ void __launch_bounds__(kNodesOfBlock)
    gather_diagonal(Layout at, const float4* partial, float factor, const float4* rest, const int* nodes, int count,
                    float4* to) {
  const int k = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (k >= count) return;
  float4 sum = sum_of_bricks(at, partial, nodes[k]), more = rest[nodes[k]];
  for_each_axis([factor](float other, float& entry) { entry = factor * entry + other; }, more, sum);
  to[k] = sum;
}
__global__ void __launch_bounds__(kNodesOfBlock) number_nodes(const int* nodes, int count, int* of_node) {
  const int k = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (k < count) of_node[nodes[k]] = k;
}

/// D of a coarse mesh, which goes down lumped, and what is fixed. A node between coarse ones that is fixed ties them by
/// its fraction of the stiffness; what else acts on a node no more than the node itself would. A corner beyond the mesh
/// moves. partial: of the diagonal of L. mass: of the finest mesh, where `finer` is that; or null.
__global__ void __launch_bounds__(kNodesOfBlock)
    descend(Layout at, const float4* partial, float factor, Map restriction, const int* fine_node, LevelNodes finer,
            const float4* mass, float4* diagonal, float4* inverse, float4* follow) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n >= at.num_nodes) return;
  float4 D = make_float4(0, 0, 0, 0), part = make_float4(1, 1, 1, 0), inverted;
  for (int k = restriction.first[n]; k < restriction.first[n + 1]; ++k) {
    const int from = restriction.column[k];
    const float weight = restriction.weight[k];
    float4 of_finer = finer.diagonal[from], m = mass ? mass[from] : of_finer, finer_inverse = finer.inverse[from];
    float4 follows = finer.follow[from];
    for_each_axis(
        [weight](float all, float own, float of_inverse, float of_follow, float& to) {
          if (of_follow == 0)
            to += of_inverse > 0 ? weight * weight / of_inverse : 0;
          else
            to += weight * (own + of_follow * (all - own));
        },
        of_finer, m, finer_inverse, follows, D);
    if (const BlockEntry* block = finer.blocks.at(from)) {
      const auto tied = [&](const float* dual) {
        float sum = 0;
        for (int a = 0; a < 3; ++a) sum += dual[a] * dual[a] * (1 - block->inverse[a] - block->rigid[a]);
        return weight * sum;
      };
      D.x += tied(block->dual), D.y += tied(block->dual + 3), D.z += tied(block->dual + 6);
    }
  }
  if (fine_node[n] >= 0) {
    float4 there = finer.follow[fine_node[n]];
    for_each_axis([](float finer_part, float& to) { to = finer_part == 0 ? 0 : 1; }, there, part);
  }
  float4 stiffness = sum_of_bricks(at, partial, n);
  for_each_axis(
      [factor](float of_L, float of_D, float& to) {
        const float sum = factor * of_L + of_D;
        to = sum > 0 ? 1 / sum : 0;
      },
      stiffness, D, inverted);
  diagonal[n] = D, inverse[n] = inverted, follow[n] = part;
}

/// r - A d at a node. partial: of L d.
__device__ inline float4 left_over(const Layout& at, const LevelNodes& level, const float4* partial, int n) {
  float4 sum = sum_of_bricks(at, partial, n), r = level.r[n], D = level.diagonal[n], d = level.d[n];
  float4 moves = level.follow[n];
  for_each_axis([&](float of_L, float of_D, float of_d, float follow,
                    float& to) { to = follow == 0 ? 0 : to - (of_D * of_d + level.factor * of_L); },
                sum, D, d, moves, r);
  if (const BlockEntry* block = level.blocks.at(n)) add_along(-1, block->dual, block->stiffness, block->dual, d, r);
  return r;
}
/// r -= A d.
__global__ void __launch_bounds__(kNodesOfBlock) subtract(Layout at, LevelNodes level, const float4* partial) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n < at.num_nodes) level.r[n] = left_over(at, level, partial, n);
}
/// A ChebyshevStep, after r -= A d where partial is not null; d has no content before a step with a = 0.
__global__ void __launch_bounds__(kNodesOfBlock)
    smooth(Layout at, LevelNodes level, const float4* partial, ChebyshevStep step) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n >= at.num_nodes) return;
  const float4 r = partial ? left_over(at, level, partial, n) : level.r[n];
  float4 z = divided(level.blocks, n, level.inverse[n], r, false), moves = level.follow[n], x = level.x[n];
  float4 d = step.a == 0 ? make_float4(0, 0, 0, 0) : level.d[n];
  for_each_axis(
      [&](float of_z, float follow, float& to, float& sum) {
        to = follow == 0 ? 0 : step.a * to + step.b * of_z;
        sum += to;
      },
      z, moves, d, x);
  level.r[n] = r, level.d[n] = d, level.x[n] = x;
}
/// r of a coarse mesh, and x = 0.
__global__ void __launch_bounds__(kNodesOfBlock)
    restrict_residual(Map restriction, LevelNodes finer, LevelNodes level) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n >= restriction.num_rows) return;
  float4 sum = make_float4(0, 0, 0, 0), moves = level.follow[n];
  for (int k = restriction.first[n]; k < restriction.first[n + 1]; ++k) {
    const int from = restriction.column[k];
    float4 r = finer.r[from], follow = finer.follow[from];
    if (const BlockEntry* block = finer.blocks.at(from)) {
      const float4 all = r;
      add_along(-1, block->dual, block->loss, block->axes, all, r);
    }
    const float weight = restriction.weight[k];
    for_each_axis([weight](float there, float part, float& to) { to += weight * part * there; }, r, follow, sum);
  }
  for_each_axis([](float follow, float& to) { to = follow == 0 ? 0 : to; }, moves, sum);
  level.r[n] = sum;
  level.x[n] = make_float4(0, 0, 0, 0);
}
/// d = P x of the coarse mesh, x += d.
__global__ void __launch_bounds__(kNodesOfBlock) prolong(Map prolongation, const float4* coarse_x, LevelNodes finer) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  if (n >= prolongation.num_rows) return;
  float4 d = make_float4(0, 0, 0, 0), x = finer.x[n], follow = finer.follow[n];
  for (int k = prolongation.first[n]; k < prolongation.first[n + 1]; ++k) {
    float4 from = coarse_x[prolongation.column[k]];
    const float weight = prolongation.weight[k];
    for_each_axis([weight](float there, float& to) { to += weight * there; }, from, d);
  }
  if (const BlockEntry* block = finer.blocks.at(n)) {
    const float4 all = d;
    add_along(-1, block->axes, block->loss, block->dual, all, d);
  }
  for_each_axis(
      [](float part, float& to, float& sum) {
        to *= part;
        sum += to;
      },
      follow, d, x);
  finer.d[n] = d, finer.x[n] = x;
}

/// What is rigid has no part in a cycle: z of the finest mesh is x and that. scalars->sum[0] = r.z.
__global__ void __launch_bounds__(kNodesOfBlock)
    finish(LevelNodes finest, const float4* all_r, double* block_sum, Scalars* scalars) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  double mine[1] = {0}, total[1];
  if (n < finest.num_nodes) {
    const float4 r = all_r[n];
    if (const BlockEntry* block = finest.blocks.at(n))
      add_along(1, block->axes, block->rigid, block->axes, r, finest.x[n]);
    mine[0] = dot(r, finest.x[n]);
  }
  if (sum_of_blocks(mine, block_sum, scalars, total)) scalars->sum[0] = total[0];
}

// Lanczos' method: v lies in d, the vector before it in r, A v in x.

/// x = A d; scalars->sum[0] = d.A d. partial: of L d.
__global__ void __launch_bounds__(kNodesOfBlock)
    multiply_lanczos(Layout at, LevelNodes level, const float4* partial, double* block_sum, Scalars* scalars) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  double mine[1] = {0}, total[1];
  if (n < at.num_nodes) {
    float4 A = sum_of_bricks(at, partial, n), D = level.diagonal[n], d = level.d[n], moves = level.follow[n];
    for_each_axis([&](float of_D, float of_d, float follow,
                      float& to) { to = follow == 0 ? 0 : of_D * of_d + level.factor * to; },
                  D, d, moves, A);
    level.x[n] = A;
    mine[0] = dot(d, A);
  }
  if (sum_of_blocks(mine, block_sum, scalars, total)) scalars->sum[0] = total[0];
}
/// With v = scale d: d = D^-1 (scale x) - along v - before r, r = v; scalars->sum[0] = d.D d, D being diag(A).
__global__ void __launch_bounds__(kNodesOfBlock)
    advance_lanczos(LevelNodes level, float scale, float along, float before, double* block_sum, Scalars* scalars) {
  const int n = blockIdx.x * kNodesOfBlock + threadIdx.x;
  double mine[1] = {0}, total[1];
  if (n < level.num_nodes) {
    float4 A = level.x[n], d = level.d[n], r = level.r[n], inverse = level.inverse[n], moves = level.follow[n];
    for_each_axis(
        [&](float of_A, float of_inverse, float follow, float& v, float& earlier) {
          const float now = scale * v, next = of_inverse * (scale * of_A) - along * now - before * earlier;
          earlier = now;
          v = follow == 0 || !(of_inverse > 0) ? 0 : next;
          if (v != 0) mine[0] += double(v) * v / of_inverse;
        },
        A, inverse, moves, d, r);
    level.d[n] = d, level.r[n] = r;
  }
  if (sum_of_blocks(mine, block_sum, scalars, total)) scalars->sum[0] = total[0];
}

}  // namespace hexaplast::one_number
