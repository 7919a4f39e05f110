// SPDX-License-Identifier: LGPL-2.1-or-later
// The stiffness of one element per SIMD lane, by its coefficients.                             theory.md section 9.3
#if defined(HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#undef HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#else
#define HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#endif

#include "elastic/assumed-inl.hpp"
#include "elastic/one_rotation-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Stores an element: its samples one after the other, then its shape.
template <int kStride, bool kGeneral, class V, class Coef>
class CoefficientWriter {
 public:
  using Element = ElementLanes<kGeneral, V>;
  using To = StoredElement<kGeneral, Coef, kStride>;

  HEXAPLAST_INLINE CoefficientWriter(const Element& element, const StiffnessKind& kind, V length, Coef* to)
      : element_(element), length_(length), to_(to), has_law_(kind.has_law()) {}

  HEXAPLAST_INLINE void add_sample(int i, const MaterialLanes<V>& of, const PressureLanes<V>& p) {
    const auto& [R, S, doubtful] = element_.polar[i];
    const Mat<V> C = product_transposed(inverse_at(element_, i), R);
    store_mat(C, length_, to_.C(i));
    Mat<V> turn;  // R_i G_i^T
    if constexpr (kGeneral) {
      assign(element_.plastic ? product_transposed(R, element_.plastic->inverse[i]) : R, turn);
      store_mat(turn, V(1.0), to_.rotation(i));
    }
    if (has_law_) {
      const Mat<V> cof = R * matrix(cofactor(S));
      const Mat<V> G = product_transposed(cof, R);
      const V k = p.in_stress_at(dilatation(of.law, S));
      const V numbers[7] = {G(0, 0),
                            G(1, 1),
                            G(2, 2),
                            G(1, 2),
                            G(2, 0),
                            G(0, 1),
                            tangent_guard(of.law, of.mooney_fraction, S, of.mu, k) / max(of.mu, V(1e-30))};
      for (int n = 0; n < 7; ++n) store_as(bounded<Coef>(numbers[n]), to_.law(i)[n]);
    } else {
      dilatations_.add_columns(i, C);
      if constexpr (kGeneral) dilatations_.add_shared(i, turn);
    }
  }

  /// of_volume: the gradient of the current volume.
  HEXAPLAST_INLINE void finish(const ModeLanes<V>& of_volume) {
    const auto& rest = element_.rest;
    if constexpr (kGeneral)
      for (int k = 0; k < 3 * kCorners; ++k) store_as(rest.h.at[k / 3][k % 3] * length_, to_.shared(k / 3)[k % 3]);
    store_mat(element_.j, length_, to_.directions());
    if constexpr (kGeneral) {
      for (int k = 0; k < 3 * kCorners; ++k) store_as(rest.mean.at[k / 3][k % 3], to_.mean(k / 3)[k % 3]);
      for (int k = 0; k < 9; ++k) store_as(rest.skew[k / 3][k % 3], to_.skew()[k]);
      store_mat(rest.dual, length_, to_.dual());
    }
    store_gradient(of_volume, length_ / rest.volume, to_.volume_gradient());
    if (has_law_) return;
    CornerLanes<V> mean;
    dilatations_.take_assumed(rest, AssumedLanes<V>(element_.j, rest.corner_weight));
    dilatations_.finish(rest, nullptr, One(), mean);
    ModeLanes<V> mean_modes;
    modes(mean, mean_modes);
    store_gradient(mean_modes, V(1.0 / (kCorners * kCorners)) * length_, to_.mean_gradient());
  }

 private:
  const Element& element_;
  V length_;
  To to_;
  bool has_law_;
  ColumnsTranspose<kGeneral, V> dilatations_;  // of all samples
};

/// What a general element does as a whole, by the gradients of its volume and of its mean dilatation: out = sum factor
/// gradient (gradient . u). Not inlined: the samples are to keep their registers.
template <bool kHasLaw, class V, class Element>
HEXAPLAST_NOINLINE void apply_as_whole(Element element, V of_ratio, V of_mean, const CornerLanes<V>& u,
                                       CornerLanes<V>& out) {
  ModeLanes<V> at, acting;
  modes(u, at);
  set_zero(acting);
  add_gradient(of_ratio * along_gradient(element.volume_gradient(), at), element.volume_gradient(), acting);
  if constexpr (!kHasLaw)
    add_gradient(of_mean * along_gradient(element.mean_gradient(), at), element.mean_gradient(), acting);
  modes_transpose(acting, out);
}

/// u <- factor L u of a general element, L = - df/dx with the rotations held fixed.
///
///   Z_i = dF~_i R_i^T,   dP_i R_i^T = 2 mu sym Z_i + (lambda_f t_i + shared) I,   t_i = tr Z_i              eq. 52, E4
///
/// With C_i = J_i^-1 G_i R_i^T the rotation, and the G_i of isolated rest shapes, cost nothing on parallelepipeds: Z_i
/// = (columns at i) C_i. General shapes keep R_i G_i^T in the place of R_i.                                      eq. P5
///
/// For the other laws G_i = R_i cof(S_i) R_i^T stands for I, also in t_i = G_i : Z_i, and beta_i Z_i is added. eq. E20
template <bool kHasLaw, int kStride, class V, class Coef>
HEXAPLAST_INLINE void apply_stiffness(const StoredElement<true, Coef, kStride>& element, const StiffnessKind& kind,
                                      StoredNumbers<2, kStride, const ScalarOf<V>> weight, V factor,
                                      CornerLanes<V>& u) {
  using T = ScalarOf<V>;
  RestLanes<true, V> rest;
  rest.corner_weight = V(static_cast<T>(kind.sampling.corner_weight));
  for (int k = 0; k < 3 * kCorners; ++k) rest.h.at[k / 3][k % 3] = load_as(element.shared(k / 3)[k % 3]);
  for (int k = 0; k < 3 * kCorners; ++k) rest.mean.at[k / 3][k % 3] = load_as(element.mean(k / 3)[k % 3]);
  for (int k = 0; k < 9; ++k) rest.skew[k / 3][k % 3] = load_as(element.skew()[k]);
  rest.dual = load_mat<V>(element.dual());
  const Mat<V> j = load_mat<V>(element.directions());
  const AssumedLanes<V> how(j, rest.corner_weight);
  ColumnLanes<true, V> columns;
  begin_columns(rest, u, columns);
  finish_columns(rest, u, how, columns);

  const ElementModuli<V> of(kind, kHasLaw, factor * load(weight[0]), factor * load(weight[1]));
  CornerLanes<V> whole;
  const V all(static_cast<T>(kCorners));  // samples weigh an eighth each
  apply_as_whole<kHasLaw>(element, all * of.of_ratio, all * of.of_mean(), u, whole);

  ColumnsTranspose<true, V> acting;
  for (int i = 0; i < kCorners; ++i) {
    const Mat<V> C = load_mat<V>(element.C(i)), R = load_mat<V>(element.rotation(i)), H = shared_at(columns, i);
    Mat<V> Z = transposed_product(columns_at(columns, i), C);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) Z(r, c) += H(r, 0) * R(c, 0) + H(r, 1) * R(c, 1) + H(r, 2) * R(c, 2);
    Mat<V> P;  // dP R^T
    if constexpr (kHasLaw)
      P = LawLanes<V>(element.law(i)).increment(Z, of.mu, of.free);
    else
      P = stress_increment(Z, of.mu, of.free);
    acting.add_columns(i, product_transposed(C, P));  // rows
    acting.add_shared(i, P * R);
  }
  acting.take_assumed(rest, how);
  acting.finish(rest, nullptr, One(), u);
  add(whole, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
