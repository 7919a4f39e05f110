// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/element_operator.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/element_kernels-inl.hpp"
#include "layout/corners-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

enum class Which { kCorotated, kLaw, kOneRotation };

/// Ap += factor L p of the elements of one register.
template <Which kWhich, bool kGeneral, class T, class Coef>
HEXAPLAST_NOINLINE void add_product_of(const ElementOperator<T, Coef>& op, int block, int lane, T factor, const T* p,
                                       T* Ap) {
  using V = Lanes<T>;
  const T* weight = op.weight.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  CornerLanes<V> u;
  gather(op.partition(), block, lane, p, u);
  const auto* const coef = stored(op, block) + lane;
  if constexpr (kWhich == Which::kOneRotation)
    apply_one_rotation<kBlock>(coef, op.kind, weight, V(factor), u);
  else
    apply_stiffness<kBlock, kGeneral, kWhich == Which::kLaw>(coef, op.kind, weight, V(factor), u);
  scatter_add(u, op.partition(), block, lane, Ap);
}

template <class T, class Coef>
void add_product(const ElementOperator<T, Coef>& op, const unsigned char* blocks, int chunk, T factor, const T* p,
                 T* Ap) {
  const Partition& partition = op.partition();
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    if (blocks && !blocks[block]) continue;
    for (int lane = 0; lane < kBlock; lane += Lanes<T>::kCount)
      if (op.kind.one_rotation)
        add_product_of<Which::kOneRotation, false>(op, block, lane, factor, p, Ap);
      else
        for_shape(
            op.is_general[block] != 0, [&]<bool kGeneral>() __attribute__((always_inline)) {
              if (op.kind.has_law())
                add_product_of<Which::kLaw, kGeneral>(op, block, lane, factor, p, Ap);
              else
                add_product_of<Which::kCorotated, kGeneral>(op, block, lane, factor, p, Ap);
            });
  }
}

/// Diagonal of L at corner a: sum_i mu |r_ia|^2 + (mu + lambda_f) r_ia,c^2 and the volume's part, r_ia = R_i g~_ia.
/// What is assumed is left out.                                                                  eq. 17, E4, E7
template <class T, class Coef>
void add_diagonal(const ElementOperator<T, Coef>& op, const unsigned char* blocks, int chunk, T factor, T* diagonal) {
  using V = Lanes<T>;
  const Partition& partition = op.partition();
  const StiffnessKind& kind = op.kind;
  const V corner_weight(static_cast<T>(kind.sampling.corner_weight)),
      quarter(static_cast<T>((1 - kind.sampling.corner_weight) / 4)), f(factor);
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    if (blocks && !blocks[block]) continue;
    const bool has_shared = op.is_general[block];
    const int of_shape = num_shape_coefficients(kind, has_shared);
    const int per_sample = kind.one_rotation ? 0 : 9 * kBlock;
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      const auto* coef = stored(op, block) + lane;
      const auto *rotation = coef + 9 * kCorners * kBlock, *shared = rotation + 9 * kCorners * kBlock;
      const auto *of_volume = coef + of_shape * kBlock,
                 *of_law = of_volume + (kind.has_volume() + kind.has_mean()) * kGradientCoefficients * kBlock;
      const T* weight = op.weight.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
      const V lambda = f * load(weight + kBlock);
      V mu = f * load(weight), free = free_modulus(mu, lambda);
      const V of_ratio = V(T(kCorners)) * (kind.has_law() ? lambda - free : lambda);
      const V of_branches = V(T(2.0 / 3)) * add_branch_modulus(kind, lambda, mu, free);
      const V of_mean = (kind.has_law() ? V(T(0)) : -(free + of_branches)) * V(T(1.0 / kCorners));
      CornerLanes<V> sum, mean;
      set_zero(sum);
      set_zero(mean);
      for (int i = 0; i < kCorners; ++i) {
        const Mat<V> C = load_mat<kBlock, V>(coef + per_sample * i);
        Mat<V> R, G;
        V beta(T(0));
        if (has_shared) R = load_mat<kBlock, V>(rotation + 9 * i * kBlock);
        if (kind.has_law()) {
          G = load_symmetric<kBlock, V>(of_law + 7 * i * kBlock);
          beta = mu * load_as(of_law + (7 * i + 6) * kBlock);
        }
        for (int a = 0; a < kCorners; ++a) {
          V r[3] = {V(T(0)), V(T(0)), V(T(0))};
          for (int d = 0; d < 3; ++d) {
            const bool same = kEdgeAt[a][d] == kEdgeAt[i][d];
            if (has_shared && !same) continue;
            V along = same ? corner_weight : V(T(0));
            if (!has_shared) along += quarter;
            if (kCornerSign[a][d] < 0) along = -along;
            for (int c = 0; c < 3; ++c) r[c] += along * C(d, c);
          }
          if (has_shared) {
            V h[3];
            for (int j = 0; j < 3; ++j) h[j] = load_as(shared + (3 * a + j) * kBlock);
            for (int c = 0; c < 3; ++c) r[c] += R(c, 0) * h[0] + R(c, 1) * h[1] + R(c, 2) * h[2];
          }
          V t[3] = {r[0], r[1], r[2]};  // what the dilatation sees
          if (kind.has_law())
            for (int c = 0; c < 3; ++c) t[c] = G(c, 0) * r[0] + G(c, 1) * r[1] + G(c, 2) * r[2];
          const V squared = (mu + beta) * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
          for (int c = 0; c < 3; ++c) {
            sum.at[a][c] += squared + mu * r[c] * r[c] + free * t[c] * t[c];
            mean.at[a][c] += t[c];
          }
        }
      }
      CornerLanes<V> of_ratio_at;
      ModeLanes<V> of_ratio_modes;
      set_zero(of_ratio_modes);
      add_gradient<kBlock>(V(T(1)), of_volume, of_ratio_modes);
      modes_transpose(of_ratio_modes, of_ratio_at);
      for (int a = 0; a < kCorners; ++a)
        for (int c = 0; c < 3; ++c) {
          const V b = of_ratio_at.at[a][c];
          sum.at[a][c] += of_mean * mean.at[a][c] * mean.at[a][c] + of_ratio * b * b;
        }
      scatter_add(sum, partition, block, lane, diagonal);
    }
  }
}

#define HEXAPLAST_ELEMENT_OPERATOR(name, T, Coef)                                                                \
  void add_product_##name(const ElementOperator<T, Coef>& op, const unsigned char* blocks, int chunk, T factor,  \
                          const T* p, T* Ap) {                                                                   \
    add_product(op, blocks, chunk, factor, p, Ap);                                                               \
  }                                                                                                              \
  void add_diagonal_##name(const ElementOperator<T, Coef>& op, const unsigned char* blocks, int chunk, T factor, \
                           T* diagonal) {                                                                        \
    add_diagonal(op, blocks, chunk, factor, diagonal);                                                           \
  }
HEXAPLAST_ELEMENT_OPERATOR(double, double, double)
HEXAPLAST_ELEMENT_OPERATOR(float, float, float)
HEXAPLAST_ELEMENT_OPERATOR(half, float, Half)

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

#define HEXAPLAST_EXPORT_ELEMENT_OPERATOR(name, T, Coef)                                                             \
  HWY_EXPORT(add_product_##name);                                                                                    \
  HWY_EXPORT(add_diagonal_##name);                                                                                   \
  template <>                                                                                                        \
  void ElementOperator<T, Coef>::add_product_of(const unsigned char* blocks, int chunk, T factor, const T* p, T* Ap) \
      const {                                                                                                        \
    HWY_DYNAMIC_DISPATCH(add_product_##name)(*this, blocks, chunk, factor, p, Ap);                                   \
  }                                                                                                                  \
  template <>                                                                                                        \
  void ElementOperator<T, Coef>::add_diagonal_of(const unsigned char* blocks, int chunk, T factor, T* diagonal)      \
      const {                                                                                                        \
    HWY_DYNAMIC_DISPATCH(add_diagonal_##name)(*this, blocks, chunk, factor, diagonal);                               \
  }
HEXAPLAST_EXPORT_ELEMENT_OPERATOR(double, double, double)
HEXAPLAST_EXPORT_ELEMENT_OPERATOR(float, float, float)
HEXAPLAST_EXPORT_ELEMENT_OPERATOR(half, float, Half)

}  // namespace hexaplast
#endif
