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

/// Stores the coefficients of an element: those of its samples one after the other, then those of its shape.
template <int kStride, bool kGeneral, Assumed kAssumed, class V, class Coef>
class CoefficientWriter {
 public:
  using Element = ElementLanes<kGeneral, kAssumed, V>;

  HEXAPLAST_INLINE CoefficientWriter(const Element& element, const StiffnessKind& kind, V length, Coef* coef)
      : element_(element),
        length_(length),
        coef_(coef),
        has_law_(kind.has_law()),
        of_law_(coef + (Places::kCount + kGradientCoefficients) * kStride) {}

  HEXAPLAST_INLINE void add_sample(int i, const MaterialLanes<V>& of, const PressureLanes<V>& p) {
    const auto& [R, S, doubtful] = element_.polar[i];
    const Mat<V> C = product_transposed(inverse_at(element_, i), R);
    store_mat<kStride>(C, length_, coef_ + (Places::kC + 9 * i) * kStride);
    Mat<V> turn;  // R_i G_i^T
    if constexpr (kGeneral) {
      assign(element_.plastic ? product_transposed(R, element_.plastic->inverse[i]) : R, turn);
      store_mat<kStride>(turn, V(1.0), coef_ + (Places::kRotation + 9 * i) * kStride);
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
      for (int n = 0; n < 7; ++n) store_as(bounded<Coef>(numbers[n]), of_law_ + (7 * i + n) * kStride);
    } else if constexpr (Places::kAssumes) {
      dilatations_.add_columns(i, C);
      if constexpr (kGeneral) dilatations_.add_shared(i, turn);
    }
  }

  /// of_volume: the gradient of the current volume, read of elements only.
  HEXAPLAST_INLINE void finish(const ModeLanes<V>& of_volume) {
    const auto& rest = element_.rest;
    Coef* to = coef_;
    if constexpr (kGeneral) store_corners<kStride>(rest.h, length_, to + Places::kShared * kStride);
    if constexpr (Places::kAssumes) store_mat<kStride>(element_.j, length_, to + Places::kDirections * kStride);
    if constexpr (Places::kHasMean) {
      store_corners<kStride>(rest.mean, V(1.0), to + Places::kMean * kStride);
      for (int k = 0; k < 9; ++k) store_as(rest.skew[k / 3][k % 3], to + (Places::kSkew + k) * kStride);
      store_mat<kStride>(rest.dual, length_, to + Places::kDual * kStride);
    }
    to += Places::kCount * kStride;
    if constexpr (Places::kAssumes) {
      store_gradient<kStride>(of_volume, length_ / rest.volume, to);
      if (has_law_) return;
      CornerLanes<V> mean;
      dilatations_.take_assumed(rest, AssumedLanes<V>(element_.j, rest.corner_weight));
      dilatations_.finish(rest, nullptr, One(), mean);
      ModeLanes<V> mean_modes;
      modes(mean, mean_modes);
      store_gradient<kStride>(mean_modes, V(1.0 / (kCorners * kCorners)) * length_,
                              to + kGradientCoefficients * kStride);
    }
  }

 private:
  using Places = CoefficientPlaces<kGeneral, kAssumed>;

  const Element& element_;
  V length_;
  Coef* coef_;
  bool has_law_;
  Coef* of_law_;
  ColumnsTranspose<kGeneral, kAssumed, V> dilatations_;  // of all samples
};

/// out = factor gradient (gradient . u), of the first and, unless it is null, of the second one. Not inlined: the
/// samples are to keep their registers.
template <int kStride, class V, class Coef>
HEXAPLAST_NOINLINE void apply_gradients(const Coef* first, V of_first, const Coef* second, V of_second,
                                        const CornerLanes<V>& u, CornerLanes<V>& out) {
  ModeLanes<V> at, acting;
  modes(u, at);
  set_zero(acting);
  add_gradient<kStride>(of_first * along_gradient<kStride>(first, at), first, acting);
  if (second) add_gradient<kStride>(of_second * along_gradient<kStride>(second, at), second, acting);
  modes_transpose(acting, out);
}

/// u <- L u, L = - df/dx with the rotations held fixed.
///
///   Z_i = dF~_i R_i^T,   dP_i R_i^T = 2 mu sym Z_i + (lambda_f t_i + shared) I,   t_i = tr Z_i              eq. 52, E4
///
/// With C_i = J_i^-1 G_i R_i^T the rotation, and the G_i of isolated rest shapes, cost nothing on parallelepipeds: Z_i
/// = (columns at i) C_i. General shapes keep R_i G_i^T in the place of R_i.                                      eq. P5
///
/// For the other laws G_i = R_i cof(S_i) R_i^T stands for I, also in t_i = G_i : Z_i, and beta_i Z_i is added. eq. E20
template <int kStride, bool kHasLaw, class V, class Coef>
HEXAPLAST_INLINE void apply_samples(const Coef* coef, const StiffnessKind& kind, const typename V::Scalar* weight,
                                    V factor, CornerLanes<V>& u) {
  using T = typename V::Scalar;
  using Places = CoefficientPlaces<true, Assumed::kCorner>;
  RestLanes<true, Assumed::kCorner, V> rest;
  rest.corner_weight = V(static_cast<T>(kind.sampling.corner_weight));
  load_corners<kStride>(coef + Places::kShared * kStride, rest.h);
  load_corners<kStride>(coef + Places::kMean * kStride, rest.mean);
  for (int k = 0; k < 9; ++k) rest.skew[k / 3][k % 3] = load_as(coef + (Places::kSkew + k) * kStride);
  rest.dual = load_mat<kStride, V>(coef + Places::kDual * kStride);
  ColumnLanes<true, Assumed::kCorner, V> columns;
  begin_columns(rest, u, columns);
  const Mat<V> j = load_mat<kStride, V>(coef + Places::kDirections * kStride);
  const AssumedLanes<V> how(j, rest.corner_weight);
  finish_columns(rest, u, how, columns);

  V mu = factor * load(weight), lambda = factor * load(weight + kStride);
  CornerLanes<V> together;  // what the element does as a whole
  const Coef* const of_volume = coef + Places::kCount * kStride;
  const Coef* const of_mean = of_volume + kGradientCoefficients * kStride;  // of the corotated law
  const Coef* const of_law = of_mean;                                       // of the others
  V free = free_modulus(mu, lambda);
  const V all(static_cast<T>(kCorners));  // samples weigh an eighth each
  const V of_ratio = all * (kHasLaw ? lambda - free : lambda);
  V of_branches(T(0));
  if constexpr (!kHasLaw) of_branches = V(T(2.0 / 3)) * add_branch_modulus(kind, lambda, mu, free);
  apply_gradients<kStride>(of_volume, of_ratio, kHasLaw ? nullptr : of_mean, all * -(free + of_branches), u, together);

  ColumnsTranspose<true, Assumed::kCorner, V> acting;
  for (int i = 0; i < kCorners; ++i) {
    const Mat<V> C = load_mat<kStride, V>(coef + (Places::kC + 9 * i) * kStride);
    const Mat<V> R = load_mat<kStride, V>(coef + (Places::kRotation + 9 * i) * kStride), H = shared_at(columns, i);
    Mat<V> Z = transposed_product(columns_at(columns, i), C);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) Z(r, c) += H(r, 0) * R(c, 0) + H(r, 1) * R(c, 1) + H(r, 2) * R(c, 2);
    Mat<V> P;  // dP R^T
    if constexpr (kHasLaw)
      P = law_increment<kStride>(of_law + 7 * i * kStride, Z, mu, free);
    else
      P = stress_increment(Z, mu, free);
    acting.add_columns(i, product_transposed(C, P));  // rows
    acting.add_shared(i, P * R);
  }
  acting.take_assumed(rest, how);
  acting.finish(rest, nullptr, One(), u);
  add(together, u);
}

/// u <- L u of elements with a rotation at each sample.
template <int kStride, bool kGeneral, bool kHasLaw, class V, class Coef>
HEXAPLAST_INLINE void apply_stiffness(const Coef* coef, const StiffnessKind& kind, const typename V::Scalar* weight,
                                      V factor, CornerLanes<V>& u) {
  if constexpr (kGeneral)
    apply_samples<kStride, kHasLaw>(coef, kind, weight, factor, u);
  else
    apply_assumed<kStride, kHasLaw>(coef, kind, weight, factor, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
