// SPDX-License-Identifier: LGPL-2.1-or-later
// Coefficients of the stiffness, stored and loaded one element per lane; and the moduli that go with them.
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

/// The coefficients of a register of elements, for a StoredElement.
template <class T, class Coef>
HEXAPLAST_INLINE auto* coefficients(ElementOperator<T, Coef>& op, int block, int lane) {
  return reinterpret_cast<typename Stored<Coef>::type*>(op.coefficients(block).data()) + lane;
}
template <class T, class Coef>
HEXAPLAST_INLINE const auto* coefficients(const ElementOperator<T, Coef>& op, int block, int lane) {
  return reinterpret_cast<const typename Stored<Coef>::type*>(op.coefficients(block).data()) + lane;
}

/// Stores the weights of a register of elements of these moduli [Pa] and volumes [m^3]; length: Model::length.
template <class V, class T, class Coef>
HEXAPLAST_INLINE void store_weights(ElementOperator<T, Coef>& op, V volume, double length, V mu, V lambda, int block,
                                    int lane) {
  const V per_sample = V(static_cast<ScalarOf<V>>(1 / (kCorners * length * length))) * volume;
  const auto weight = op.weights(block, lane);
  store_as(per_sample * mu, weight[0]);
  store_as(per_sample * lambda, weight[1]);
}

/// Calls f with the StoredElement or StoredOneRotation of a register of elements.
template <class T, class Coef, class F>
HEXAPLAST_INLINE void visit_stored(const ElementOperator<T, Coef>& op, int block, int lane, const F& f) {
  const auto* const from = coefficients(op, block, lane);
  using Number = std::remove_pointer_t<decltype(from)>;
  if constexpr (std::is_same_v<Coef, Half>)
    if (op.kind.one_rotation) return f(StoredOneRotation<Number>(from));
  for_shape(
      op.is_general[block] != 0, [&]<bool kGeneral>()
                                     __attribute__((always_inline)) { f(StoredElement<kGeneral, Number>(from)); });
}

template <class V, int kStride, class Coef>
HEXAPLAST_INLINE Mat<V> load_mat(StoredNumbers<9, kStride, Coef> from) {
  Mat<V> M;
  for (int k = 0; k < 9; ++k) M.m[k / 3][k % 3] = load_as(from[k]);
  return M;
}
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void store_mat(const Mat<V>& M, V scale, StoredNumbers<9, kStride, Coef> to) {
  for (int k = 0; k < 9; ++k) store_as(M.m[k / 3][k % 3] * scale, to[k]);
}

/// What grows with the stretch, within the numbers that a half can be.
template <class Coef, class V>
HEXAPLAST_INLINE V bounded(V a) {
  if constexpr (!std::is_same_v<Coef, StoredHalf>) return a;
  constexpr ScalarOf<V> kLargest(3e4);
  return min(max(a, V(-kLargest)), V(kLargest));
}

/// The moduli of an element, in units of the given mu and lambda; of the corotated law with branches.
template <class V>
struct ElementModuli {
  HEXAPLAST_INLINE ElementModuli(const StiffnessKind& kind, bool has_law, V mu_, V lambda_)
      : mu(mu_), free(free_modulus(mu, lambda_)), of_ratio(has_law ? lambda_ - free : lambda_) {
    using T = ScalarOf<V>;
    const auto& [sum, in_step] = kind.branches;
    if (has_law || in_step == 0) return;
    const V of_branches = V(static_cast<T>(in_step)) * mu;
    free += V(static_cast<T>(2 * in_step / sum)) * mu * branch_free_modulus(mu, lambda_, V(static_cast<T>(sum)));
    mu += of_branches;
    bulk = V(T(2.0 / 3)) * of_branches;
  }
  /// Of the mean dilatation of the samples, which has the free modulus in each of them.
  HEXAPLAST_INLINE V of_mean() const { return -(free + bulk); }

  V mu;                    ///< of a sample: mu + mu_b                                                      eq. P14
  V free;                  ///< of its own dilatation: lambda_f + 2 w mu_b                              eq. E2, P14
  V of_ratio;              ///< of the volume ratio: lambda, or lambda - lambda_f of the other laws
  V bulk{ScalarOf<V>(0)};  ///< 2/3 mu_b: what branches do not add to the resistance to dilatation
};

/// A law other than the corotated one at a sample: R cof(S) R^T and beta.                                     eq. E20
template <class V>
struct LawLanes {
  LawLanes() = default;
  template <int kStride, class Coef>
  HEXAPLAST_INLINE explicit LawLanes(StoredNumbers<7, kStride, Coef> from)
      : G(matrix(Sym<V>{load_as(from[0]), load_as(from[1]), load_as(from[2]), load_as(from[3]), load_as(from[4]),
                        load_as(from[5])})),
        beta(load_as(from[6])) {}

  /// dP R^T
  HEXAPLAST_INLINE Mat<V> increment(const Mat<V>& Z, V mu, V free) const {
    const V pressure = free * dot(G, Z), more = mu * beta;
    Mat<V> P = stress_increment(Z, mu, V(ScalarOf<V>(0)));
    for (int k = 0; k < 9; ++k) P.m[k / 3][k % 3] += pressure * G.m[k / 3][k % 3] + more * Z.m[k / 3][k % 3];
    return P;
  }

  Mat<V> G;
  V beta;  ///< over mu
};

template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void store_gradient(const ModeLanes<V>& gradient, V scale, StoredNumbers<21, kStride, Coef> to) {
  unrolled<21>([&](auto k) __attribute__((always_inline)) {
    store_as(bounded<Coef>(gradient.at[k / 3][k % 3] * scale), to[k]);
  });
}
/// gradient . u
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE V along_gradient(StoredNumbers<21, kStride, Coef> gradient, const ModeLanes<V>& u) {
  V sum[3];  // not one chain
  unrolled<21>([&](auto k) __attribute__((always_inline)) {
    const V part = load_as(gradient[k]) * u.at[k / 3][k % 3];
    sum[k % 3] = k < 3 ? part : sum[k % 3] + part;
  });
  return sum[0] + sum[1] + sum[2];
}
/// What acts on the modes += factor gradient
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void add_gradient(V factor, StoredNumbers<21, kStride, Coef> gradient, ModeLanes<V>& acting) {
  unrolled<21>([&](auto k)
                   __attribute__((always_inline)) { acting.at[k / 3][k % 3] += factor * load_as(gradient[k]); });
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
