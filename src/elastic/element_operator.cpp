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

/// Ap += factor L p of the elements of one register.
template <bool kHasLaw, class Element, class T, class Coef>
HEXAPLAST_NOINLINE void add_product_of(const ElementOperator<T, Coef>& op, Element element, int block, int lane,
                                       T factor, const T* p, T* Ap) {
  using V = Lanes<T>;
  CornerLanes<V> u;
  gather(op.partition(), block, lane, p, u);
  apply_stiffness<kHasLaw>(element, op.kind, op.weights(block, lane), V(factor), u);
  scatter_add(u, op.partition(), block, lane, Ap);
}

/// Of a sample r_ia = R_i g~_ia, by which the displacement of corner a comes into Z_i. What is assumed is left out.
template <class V, class Element>
HEXAPLAST_INLINE void corner_gradients(Element element, int i, V corner_weight, V quarter, V (&r)[kCorners][3]) {
  const Mat<V> C = load_mat<V>(element.C(i));
  Mat<V> R;
  if constexpr (Element::kIsGeneral) R = load_mat<V>(element.rotation(i));
  for (int a = 0; a < kCorners; ++a) {
    for (V& entry : r[a]) entry = V(ScalarOf<V>(0));
    for (int d = 0; d < 3; ++d) {
      const bool same = kEdgeAt[a][d] == kEdgeAt[i][d];
      if (Element::kIsGeneral && !same) continue;
      V along = same ? corner_weight : V(ScalarOf<V>(0));
      if (!Element::kIsGeneral) along += quarter;
      if (kCornerSign[a][d] < 0) along = -along;
      for (int c = 0; c < 3; ++c) r[a][c] += along * C(d, c);
    }
    if constexpr (Element::kIsGeneral) {
      V h[3];
      for (int j = 0; j < 3; ++j) h[j] = load_as(element.shared(a)[j]);
      for (int c = 0; c < 3; ++c) r[a][c] += R(c, 0) * h[0] + R(c, 1) * h[1] + R(c, 2) * h[2];
    }
  }
}

/// sum, mean += what the samples have in the diagonal, and t_ia over all of them.
template <bool kHasLaw, class V, class Element>
HEXAPLAST_INLINE void add_samples(Element element, const ElementModuli<V>& of, double weight, CornerLanes<V>& sum,
                                  CornerLanes<V>& mean) {
  using T = ScalarOf<V>;
  const V corner_weight(static_cast<T>(weight)), quarter(static_cast<T>((1 - weight) / 4));
  for (int i = 0; i < kCorners; ++i) {
    V r[kCorners][3];
    corner_gradients(element, i, corner_weight, quarter, r);
    for (int a = 0; a < kCorners; ++a) {
      V t[3] = {r[a][0], r[a][1], r[a][2]};  // what the dilatation sees
      V shear = of.mu;
      if constexpr (kHasLaw) {
        const LawLanes<V> law(element.law(i));
        for (int c = 0; c < 3; ++c) t[c] = law.G(c, 0) * r[a][0] + law.G(c, 1) * r[a][1] + law.G(c, 2) * r[a][2];
        shear += of.mu * law.beta;
      }
      const V squared = shear * (r[a][0] * r[a][0] + r[a][1] * r[a][1] + r[a][2] * r[a][2]);
      for (int c = 0; c < 3; ++c) {
        sum.at[a][c] += squared + of.mu * r[a][c] * r[a][c] + of.free * t[c] * t[c];
        mean.at[a][c] += t[c];
      }
    }
  }
}
/// The same where all samples have one C, with M_a = sum_d s_d(a) C_d: r_ia is (1 + 3 w) / 4 M_a of the sample at the
/// corner, (1 - w) / 4 M_a + w s_d C_d of its neighbour along d, and (1 - w) / 4 M_a of the four others.
///
///   sum_i r_ia^2 = (1 + w^2) / 2 M_a^2 + w^2 sum_d C_d^2,   sum_i r_ia = 2 M_a
template <bool kHasLaw, class V, class Coef, int kStride>
HEXAPLAST_INLINE void add_samples(StoredOneRotation<Coef, kStride> element, const ElementModuli<V>& of, double weight,
                                  CornerLanes<V>& sum, CornerLanes<V>& mean) {
  using T = ScalarOf<V>;
  const Mat<V> C = load_mat<V>(element.directions());
  const V of_corner(static_cast<T>((1 + weight * weight) / 2)), of_all(static_cast<T>(weight * weight));
  V shared[3];
  for (int c = 0; c < 3; ++c) shared[c] = of_all * (C(0, c) * C(0, c) + C(1, c) * C(1, c) + C(2, c) * C(2, c));
  for (int a = 0; a < kCorners; ++a) {
    V squares[3];
    for (int c = 0; c < 3; ++c) {
      V M(T(0));
      for (int d = 0; d < 3; ++d) M = kCornerSign[a][d] < 0 ? M - C(d, c) : M + C(d, c);
      squares[c] = of_corner * M * M + shared[c];
      mean.at[a][c] += M + M;
    }
    const V squared = of.mu * (squares[0] + squares[1] + squares[2]);
    for (int c = 0; c < 3; ++c) sum.at[a][c] += squared + (of.mu + of.free) * squares[c];
  }
}

/// Diagonal of factor L at corner a: sum_i mu |r_ia|^2 + (mu + lambda_f) r_ia,c^2 and the part of the element as a
/// whole.                                                                                               eq. 17, E4, E7
template <bool kHasLaw, class Element, class T, class Coef>
HEXAPLAST_NOINLINE void add_diagonal_of(const ElementOperator<T, Coef>& op, Element element, int block, int lane,
                                        T factor, T* diagonal) {
  using V = Lanes<T>;
  const StiffnessKind& kind = op.kind;
  const auto weight = op.weights(block, lane);
  const V f(factor);
  const ElementModuli<V> of(kind, kHasLaw, f * load(weight[0]), f * load(weight[1]));
  CornerLanes<V> sum, mean;
  set_zero(sum);
  set_zero(mean);
  add_samples<kHasLaw>(element, of, kind.sampling.corner_weight, sum, mean);
  const V of_ratio = V(T(kCorners)) * of.of_ratio;
  const V of_mean = (kHasLaw ? V(T(0)) : of.of_mean()) * V(T(1.0 / kCorners));
  ModeLanes<V> volume_gradient;
  CornerLanes<V> b;
  set_zero(volume_gradient);
  add_gradient(V(T(1)), element.volume_gradient(), volume_gradient);
  modes_transpose(volume_gradient, b);
  for (int a = 0; a < kCorners; ++a)
    for (int c = 0; c < 3; ++c)
      sum.at[a][c] += of_mean * mean.at[a][c] * mean.at[a][c] + of_ratio * b.at[a][c] * b.at[a][c];
  scatter_add(sum, op.partition(), block, lane, diagonal);
}

/// Calls f.template operator()<has law>(stored element, block, lane) for every register of elements of a chunk, of the
/// blocks whose entry is not 0.
template <class T, class Coef, class F>
HEXAPLAST_INLINE void for_each_register(const ElementOperator<T, Coef>& op, const unsigned char* blocks, int chunk,
                                        const F& f) {
  const Partition& partition = op.partition();
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    if (blocks && !blocks[block]) continue;
    for (int lane = 0; lane < kBlock; lane += Lanes<T>::kCount)
      visit_stored(
          op, block, lane, [&]<class Element>(Element element) __attribute__((always_inline)) {
            if constexpr (Element::kMayHaveLaw)
              if (op.kind.has_law()) return f.template operator()<true>(element, block, lane);
            f.template operator()<false>(element, block, lane);
          });
  }
}

template <class T, class Coef>
void add_product(const ElementOperator<T, Coef>& op, const unsigned char* blocks, int chunk, T factor, const T* p,
                 T* Ap) {
  for_each_register(op, blocks, chunk, [&]<bool kHasLaw>(auto element, int block, int lane) {
    add_product_of<kHasLaw>(op, element, block, lane, factor, p, Ap);
  });
}

template <class T, class Coef>
void add_diagonal(const ElementOperator<T, Coef>& op, const unsigned char* blocks, int chunk, T factor, T* diagonal) {
  for_each_register(op, blocks, chunk, [&]<bool kHasLaw>(auto element, int block, int lane) {
    add_diagonal_of<kHasLaw>(op, element, block, lane, factor, diagonal);
  });
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
