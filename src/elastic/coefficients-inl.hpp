// SPDX-License-Identifier: LGPL-2.1-or-later
// Coefficients of the stiffness as they are stored: [component][element], kStride elements.
#if defined(HEXAPLAST_ELASTIC_COEFFICIENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELASTIC_COEFFICIENTS_INL
#undef HEXAPLAST_ELASTIC_COEFFICIENTS_INL
#else
#define HEXAPLAST_ELASTIC_COEFFICIENTS_INL
#endif

#include "element/element-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "kinematics/modes-inl.hpp"
#include "state/element_operator.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// The type that lanes load a stored coefficient as.
template <class Coef>
struct Stored {
  using type = Coef;
};
template <>
struct Stored<Half> {
  using type = StoredHalf;
};

template <class T, class Coef>
HEXAPLAST_INLINE const typename Stored<Coef>::type* stored(const ElementOperator<T, Coef>& op, int block) {
  return reinterpret_cast<const typename Stored<Coef>::type*>(op.coef.data() + op.offset[block]);
}

template <int kStride, class V, class Coef>
HEXAPLAST_INLINE Mat<V> load_mat(const Coef* from) {
  Mat<V> M;
  for (int k = 0; k < 9; ++k) M.m[k / 3][k % 3] = load_as(from + k * kStride);
  return M;
}
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE Mat<V> load_symmetric(const Coef* from) {
  return matrix(Sym<V>{load_as(from), load_as(from + kStride), load_as(from + 2 * kStride), load_as(from + 3 * kStride),
                       load_as(from + 4 * kStride), load_as(from + 5 * kStride)});
}
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void load_corners(const Coef* from, CornerLanes<V>& corners) {
  for (int a = 0; a < kCorners; ++a)
    for (int j = 0; j < 3; ++j) corners.at[a][j] = load_as(from + (3 * a + j) * kStride);
}
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void store_mat(const Mat<V>& M, V scale, Coef* to) {
  for (int k = 0; k < 9; ++k) store_as(M.m[k / 3][k % 3] * scale, to + k * kStride);
}
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void store_corners(const CornerLanes<V>& corners, V scale, Coef* to) {
  for (int a = 0; a < kCorners; ++a)
    for (int j = 0; j < 3; ++j) store_as(corners.at[a][j] * scale, to + (3 * a + j) * kStride);
}

/// What grows with the stretch, within the numbers that a half can be.
template <class Coef, class V>
HEXAPLAST_INLINE V bounded(V a) {
  if constexpr (!std::is_same_v<Coef, StoredHalf>) return a;
  constexpr double kLargest = 3e4;
  return min(max(a, V(-kLargest)), V(kLargest));
}

/// Moduli of samples with branches: mu + mu_b, and lambda_f + 2 w mu_b. Returns mu_b.                          eq. P14
template <class V>
HEXAPLAST_INLINE V add_branch_modulus(const StiffnessKind& kind, V lambda, V& mu, V& free) {
  using T = ScalarOf<V>;
  if (kind.branch_modulus == 0) return V(T(0));
  const V more = V(static_cast<T>(kind.branch_modulus)) * mu;
  free += V(static_cast<T>(2 * kind.branch_modulus / kind.branch_moduli)) * mu *
          branch_free_modulus(mu, lambda, V(static_cast<T>(kind.branch_moduli)));
  mu += more;
  return more;
}

/// dP R^T of a sample with one of the other laws, which store G = R cof(S) R^T and beta.                      eq. E20
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE Mat<V> law_increment(const Coef* of_law, const Mat<V>& Z, V mu, V free) {
  const Mat<V> G = load_symmetric<kStride, V>(of_law);
  const V pressure = free * dot(G, Z), beta = mu * load_as(of_law + 6 * kStride);
  Mat<V> P = stress_increment(Z, mu, V(ScalarOf<V>(0)));
  for (int k = 0; k < 9; ++k) P.m[k / 3][k % 3] += pressure * G.m[k / 3][k % 3] + beta * Z.m[k / 3][k % 3];
  return P;
}

// Gradients at the corners by their modes: the sum of the corners is zero, and rounding does not change that.

template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void store_gradient(const ModeLanes<V>& gradient, V scale, Coef* to) {
  unrolled<kGradientCoefficients>([&](auto k) __attribute__((always_inline)) {
    store_as(bounded<Coef>(gradient.at[k / 3][k % 3] * scale), to + k * kStride);
  });
}
/// gradient . u
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE V along_gradient(const Coef* gradient, const ModeLanes<V>& u) {
  V sum[3];  // not one chain
  unrolled<kGradientCoefficients>([&](auto k) __attribute__((always_inline)) {
    const V part = load_as(gradient + k * kStride) * u.at[k / 3][k % 3];
    sum[k % 3] = k < 3 ? part : sum[k % 3] + part;
  });
  return sum[0] + sum[1] + sum[2];
}
/// What acts on the modes += factor gradient
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void add_gradient(V factor, const Coef* gradient, ModeLanes<V>& acting) {
  unrolled<kGradientCoefficients>([&](auto k) __attribute__((always_inline)) {
    acting.at[k / 3][k % 3] += factor * load_as(gradient + k * kStride);
  });
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
