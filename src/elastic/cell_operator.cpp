// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/cell_operator.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/cell_operator.hpp"
#include "hexaplast/base/parallel.hpp"
#include "kinematics/gradients-inl.hpp"
#include "kinematics/modes-inl.hpp"
#include "kinematics/polar-inl.hpp"
#include "layout/corners-inl.hpp"
#include "state/linearization.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

constexpr int kModes = kCorners - 1;
constexpr Sampling kOfCells = {};  // corner and mean gradient in equal parts
constexpr int place_of(int row, int column) { return column * (2 * CellOperator::kSize - 1 - column) / 2 + row; }

/// Gradients of the modes at the samples of the cells of a block, in their rotated frames:
///
///   rho_im = R_i G_i^T sum_a s_m(a) g_ia / 8,   F_i R_i^T = sum_m u_m (x) rho_im
struct ModeGradients {
  alignas(64) float at[kCorners][kModes][3][kBlock];
};

/// Those of one register of cells. Returns a bit per cell that is there and not inside out.
HEXAPLAST_NOINLINE std::uint32_t find_gradients(const Partition& partition, const double* plastic_rest,
                                                const double* current, const float* mean_plastic, double length,
                                                int block, int lane, ModeGradients& rho) {
  using V = Lanes<float>;
  std::uint32_t present = 0;
  for (int k = 0; k < V::kCount; ++k) present |= (partition.element(block, lane + k) >= 0 ? 1u : 0u) << k;
  CornerLanes<V> x, u;
  gather_about_corner<float>(partition, block, lane, plastic_rest, x);
  gather_about_corner<float>(partition, block, lane, current, u);
  // corners beyond the mesh may lie anywhere: cells that they invert do not help
  replace_absent(present, x);
  RestLanes<true, V> rest;
  rest_operator(x, kOfCells, rest);
  present &= bits<float>(rest.min_jacobian > V(0.0f));
  replace_absent(present, x);
  replace_absent(present, u);
  rest_operator(x, kOfCells, rest);

  ModeLanes<V> at, gradients[kCorners];
  modes(u, at);
  Mat<V> F[kCorners];
  for (int i = 0; i < kCorners; ++i) {
    CornerLanes<V> g = rest.h;
    for (int d = 0; d < 3; ++d)
      for (const int a : {i, static_cast<int>(kEdgeNeighbour[i][d])}) {
        const V sign = kCornerSign[a][d] < 0 ? -rest.corner_weight : rest.corner_weight;
        for (int c = 0; c < 3; ++c) g.at[a][c] += sign * rest.inverse[i](d, c);
      }
    modes(g, gradients[i]);
    if (mean_plastic) {  // each sample has that of its child, a lower triangle
      const float* Gm = mean_plastic + (static_cast<std::size_t>(block) * kCorners + i) * kMeanPlastic * kBlock + lane;
      for (auto& mode : gradients[i].at) {
        const V before[3] = {mode[0], mode[1], mode[2]};
        for (int c = 0; c < 3; ++c) {
          mode[c] = V(0.0f);
          for (int r = c; r < 3; ++r) mode[c] += before[r] * load(Gm + of_mean_plastic(r, c) * kBlock);
        }
      }
    }
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        F[i](r, c) = V(0.0f);
        for (int m = 0; m < kModes; ++m) F[i](r, c) += at.at[m][r] * gradients[i].at[m][c];
      }
  }
  const V scale(static_cast<float>(length / kCorners));
  for (int first = 0; first < kCorners; first += kAtOnce) {
    PolarLanes<V> polar[kAtOnce];
    safe_polars<kAtOnce>(F + first, polar);  // of 8 F_i
    for (int k = 0; k < kAtOnce; ++k)
      for (int m = 0; m < kModes; ++m) {
        const V* const g = gradients[first + k].at[m];
        const Mat<V>& R = polar[k].R;
        for (int c = 0; c < 3; ++c)
          store(scale * (R(c, 0) * g[0] + R(c, 1) * g[1] + R(c, 2) * g[2]), rho.at[first + k][m][c] + lane);
      }
  }
  return present;
}

/// The matrices of one register of cells: between two modes
///
///   K_mn = sum_i mu_i [(rho_im . rho_in) I + rho_in (x) rho_im] + lambda_i rho_im (x) rho_in
HEXAPLAST_NOINLINE void find_matrices(const ModeGradients& rho, const float* moduli, int lane, float* matrices) {
  using V = Lanes<float>;
  V of_mu[kCorners][kModes][3], of_lambda[kCorners][kModes][3];
  for (int i = 0; i < kCorners; ++i) {
    const V mu = load(moduli + 2 * i * kBlock), lambda = load(moduli + (2 * i + 1) * kBlock);
    for (int m = 0; m < kModes; ++m)
      for (int c = 0; c < 3; ++c) {
        const V entry = load(rho.at[i][m][c] + lane);
        of_mu[i][m][c] = mu * entry;
        of_lambda[i][m][c] = lambda * entry;
      }
  }
  for (int m = 0; m < kModes; ++m)
    for (int n = 0; n <= m; ++n) {
      Mat<V> K;
      for (auto& row : K.m)
        for (V& entry : row) entry = V(0.0f);
      for (int i = 0; i < kCorners; ++i) {
        V r[3];
        for (int c = 0; c < 3; ++c) r[c] = load(rho.at[i][m][c] + lane);
        const V(&by_mu)[3] = of_mu[i][n], (&by_lambda)[3] = of_lambda[i][n];
        const V both = r[0] * by_mu[0] + r[1] * by_mu[1] + r[2] * by_mu[2];
        for (int c = 0; c < 3; ++c) {
          K(c, c) += both;
          for (int d = 0; d < 3; ++d) K(c, d) += by_mu[c] * r[d] + r[c] * by_lambda[d];
        }
      }
      for (int c = 0; c < 3; ++c)
        for (int d = 0; d < (m == n ? c + 1 : 3); ++d)
          store(K(c, d), matrices + place_of(3 * m + c, 3 * n + d) * kBlock);
    }
}

void update_cells(const Partition& partition, const double* plastic_rest, const double* current,
                  const float* mean_plastic, double length, int chunk, float* moduli, float* matrices) {
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    ModeGradients rho;
    float* const of_block = moduli + static_cast<std::size_t>(block) * kCorners * 2 * kBlock;
    for (int lane = 0; lane < kBlock; lane += Lanes<float>::kCount) {
      const std::uint32_t present =
          find_gradients(partition, plastic_rest, current, mean_plastic, length, block, lane, rho);
      for (int k = 0; k < Lanes<float>::kCount; ++k)
        for (int n = 0; n < 2 * kCorners && !(present >> k & 1); ++n) of_block[n * kBlock + lane + k] = 0;
      find_matrices(rho, of_block + lane, lane,
                    matrices + static_cast<std::size_t>(block) * CellOperator::kEntries * kBlock + lane);
    }
  }
}

/// u <- K u
HEXAPLAST_INLINE void apply_matrix(const float* matrix, Lanes<float> factor, CornerLanes<Lanes<float>>& u) {
  using V = Lanes<float>;
  ModeLanes<V> at, acting;
  modes(u, at);
  unrolled<CellOperator::kSize>([&](auto column) __attribute__((always_inline)) {
    constexpr int c = column;
    const V along = factor * at.at[c / 3][c % 3];
    V sum = load(matrix + place_of(c, c) * kBlock) * along;
    for (int r = c + 1; r < CellOperator::kSize; ++r) {
      const V entry = load(matrix + place_of(r, c) * kBlock);
      V& to = acting.at[r / 3][r % 3];
      to = c == 0 ? entry * along : to + entry * along;
      sum += entry * (factor * at.at[r / 3][r % 3]);
    }
    V& to = acting.at[c / 3][c % 3];
    to = c == 0 ? sum : to + sum;
  });
  modes_transpose(acting, u);
}

void add_cell_products(const Partition& partition, const float* matrices, int chunk, float factor, const float* p,
                       float* Ap) {
  using V = Lanes<float>;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      CornerLanes<V> u;
      gather(partition, block, lane, p, u);
      apply_matrix(matrices + static_cast<std::size_t>(block) * CellOperator::kEntries * kBlock + lane, V(factor), u);
      scatter_add(u, partition, block, lane, Ap);
    }
}

/// The mode whose signs are those of two others, multiplied; -1: the mean of the corners.
constexpr int product_of_modes(int m, int n) {
  constexpr int kBits[kModes] = {1, 2, 4, 6, 5, 3, 7};  // the coordinates of which it has the sign
  for (int k = 0; k < kModes; ++k)
    if (kBits[k] == (kBits[m] ^ kBits[n])) return k;
  return -1;
}

/// sum_mn s_m(a) s_n(a) K_mn at the corners a
void add_cell_diagonals(const Partition& partition, const float* matrices, int chunk, float factor, float* diagonal) {
  using V = Lanes<float>;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      const float* const matrix = matrices + static_cast<std::size_t>(block) * CellOperator::kEntries * kBlock + lane;
      ModeLanes<V> differing;
      V same[3] = {V(0.0f), V(0.0f), V(0.0f)};
      set_zero(differing);
      for (int m = 0; m < kModes; ++m)
        for (int c = 0; c < 3; ++c) {
          same[c] += V(factor) * load(matrix + place_of(3 * m + c, 3 * m + c) * kBlock);
          for (int n = 0; n < m; ++n)
            differing.at[product_of_modes(m, n)][c] +=
                V(2 * factor) * load(matrix + place_of(3 * m + c, 3 * n + c) * kBlock);
        }
      CornerLanes<V> sum;
      modes_transpose(differing, sum);
      for (auto& corner : sum.at)
        for (int c = 0; c < 3; ++c) corner[c] += same[c];
      scatter_add(sum, partition, block, lane, diagonal);
    }
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(update_cells);
HWY_EXPORT(add_cell_products);
HWY_EXPORT(add_cell_diagonals);

CellOperator::CellOperator(std::shared_ptr<const Partition> partition)
    : partition_(std::move(partition)),
      moduli_(static_cast<std::size_t>(partition_->num_blocks) * kCorners * 2 * kBlock),
      matrices_(static_cast<std::size_t>(partition_->num_blocks) * kEntries * kBlock) {}

void CellOperator::update(const double* plastic_rest, const double* current, const float* mean_plastic, double length) {
  parallel_for(partition_->num_chunks, [&](int chunk) {
    HWY_DYNAMIC_DISPATCH(update_cells)
    (*partition_, plastic_rest, current, mean_plastic, length, chunk, moduli_.data(), matrices_.data());
  });
}
void CellOperator::add_product(int chunk, float factor, const float* p, float* Ap) const {
  HWY_DYNAMIC_DISPATCH(add_cell_products)(*partition_, matrices_.data(), chunk, factor, p, Ap);
}
void CellOperator::add_diagonal(int chunk, float factor, float* diagonal) const {
  HWY_DYNAMIC_DISPATCH(add_cell_diagonals)(*partition_, matrices_.data(), chunk, factor, diagonal);
}

}  // namespace hexaplast
#endif
