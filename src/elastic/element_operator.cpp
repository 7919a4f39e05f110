// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/element_operator.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/element_kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

template <class T, class Coef>
void add_product(const ElementOperator<T, Coef>& op, int chunk, T factor, const T* p, T* Ap) {
  using V = Lanes<T>;
  const Partition& partition = op.partition();
  const V share(static_cast<T>(op.corner_weight)), f(factor);
  const int weights = op.per_sample ? 2 * kCorners * kBlock : 2 * kBlock;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    const auto* coef = stored(op, block);
    const T* weight = op.weight.data() + static_cast<std::size_t>(block) * weights;
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      CornerLanes<V> u;
      gather(partition, block, lane, p, u);
      if (op.per_sample)
        apply_stiffness<true, true>(coef + lane, weight + lane, share, f, u);
      else if (op.is_general[block])
        apply_stiffness<true, false>(coef + lane, weight + lane, share, f, u);
      else
        apply_stiffness<false, false>(coef + lane, weight + lane, share, f, u);
      scatter_add(u, partition, block, lane, Ap);
    }
  }
}

/// Diagonal of L at corner a: sum_i mu |r_ia|^2 + (mu + lambda) r_ia,c^2, r_ia = R_i g~_ia.                  eq. 17
template <class T, class Coef>
void add_diagonal(const ElementOperator<T, Coef>& op, int chunk, T factor, T* diagonal) {
  using V = Lanes<T>;
  const Partition& partition = op.partition();
  const V share(static_cast<T>(op.corner_weight)), quarter(static_cast<T>((1 - op.corner_weight) / 4)), f(factor);
  const int weights = op.per_sample ? 2 * kCorners * kBlock : 2 * kBlock;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    const bool general = op.per_sample || op.is_general[block];
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      const auto* coef = stored(op, block) + lane;
      const auto *rotation = coef + 9 * kCorners * kBlock, *shared = rotation + 9 * kCorners * kBlock;
      const T* weight = op.weight.data() + static_cast<std::size_t>(block) * weights + lane;
      CornerLanes<V> sum;
      for (auto& corner : sum.at)
        for (V& d : corner) d = V(T(0));
      for (int i = 0; i < kCorners; ++i) {
        const T* at = op.per_sample ? weight + 2 * i * kBlock : weight;
        const V mu = f * load(at), both = mu + f * load(at + kBlock);
        const Mat<V> C = load_mat<V>(coef + 9 * i * kBlock);
        Mat<V> R;
        if (general) R = load_mat<V>(rotation + 9 * i * kBlock);
        for (int a = 0; a < kCorners; ++a) {
          V r[3] = {V(T(0)), V(T(0)), V(T(0))};
          for (int d = 0; d < 3; ++d) {
            const bool same = kEdgeAt[a][d] == kEdgeAt[i][d];
            if (general && !same) continue;
            V along = same ? share : V(T(0));
            if (!general) along += quarter;
            if (kCornerSign[a][d] < 0) along = -along;
            for (int c = 0; c < 3; ++c) r[c] += along * C(d, c);
          }
          if (general) {
            V h[3];
            for (int j = 0; j < 3; ++j) h[j] = load_as(shared + (3 * a + j) * kBlock);
            for (int c = 0; c < 3; ++c) r[c] += R(c, 0) * h[0] + R(c, 1) * h[1] + R(c, 2) * h[2];
          }
          const V squared = mu * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
          for (int c = 0; c < 3; ++c) sum.at[a][c] += squared + both * r[c] * r[c];
        }
      }
      scatter_add(sum, partition, block, lane, diagonal);
    }
  }
}

void add_product_double(const ElementOperator<double, double>& op, int chunk, double factor, const double* p,
                        double* Ap) {
  add_product(op, chunk, factor, p, Ap);
}
void add_diagonal_double(const ElementOperator<double, double>& op, int chunk, double factor, double* diagonal) {
  add_diagonal(op, chunk, factor, diagonal);
}
void add_product_float(const ElementOperator<float, float>& op, int chunk, float factor, const float* p, float* Ap) {
  add_product(op, chunk, factor, p, Ap);
}
void add_diagonal_float(const ElementOperator<float, float>& op, int chunk, float factor, float* diagonal) {
  add_diagonal(op, chunk, factor, diagonal);
}
void add_product_half(const ElementOperator<float, Half>& op, int chunk, float factor, const float* p, float* Ap) {
  add_product(op, chunk, factor, p, Ap);
}
void add_diagonal_half(const ElementOperator<float, Half>& op, int chunk, float factor, float* diagonal) {
  add_diagonal(op, chunk, factor, diagonal);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(add_product_double);
HWY_EXPORT(add_diagonal_double);
HWY_EXPORT(add_product_float);
HWY_EXPORT(add_diagonal_float);
HWY_EXPORT(add_product_half);
HWY_EXPORT(add_diagonal_half);

template <>
void ElementOperator<double, double>::add_product(int chunk, double factor, const double* p, double* Ap) const {
  HWY_DYNAMIC_DISPATCH(add_product_double)(*this, chunk, factor, p, Ap);
}
template <>
void ElementOperator<double, double>::add_diagonal(int chunk, double factor, double* diagonal) const {
  HWY_DYNAMIC_DISPATCH(add_diagonal_double)(*this, chunk, factor, diagonal);
}
template <>
void ElementOperator<float, float>::add_product(int chunk, float factor, const float* p, float* Ap) const {
  HWY_DYNAMIC_DISPATCH(add_product_float)(*this, chunk, factor, p, Ap);
}
template <>
void ElementOperator<float, float>::add_diagonal(int chunk, float factor, float* diagonal) const {
  HWY_DYNAMIC_DISPATCH(add_diagonal_float)(*this, chunk, factor, diagonal);
}
template <>
void ElementOperator<float, Half>::add_product(int chunk, float factor, const float* p, float* Ap) const {
  HWY_DYNAMIC_DISPATCH(add_product_half)(*this, chunk, factor, p, Ap);
}
template <>
void ElementOperator<float, Half>::add_diagonal(int chunk, float factor, float* diagonal) const {
  HWY_DYNAMIC_DISPATCH(add_diagonal_half)(*this, chunk, factor, diagonal);
}

}  // namespace hexaplast
#endif
