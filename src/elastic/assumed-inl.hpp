// SPDX-License-Identifier: LGPL-2.1-or-later
// The stiffness of parallelepipeds with assumed strains, from modes.                      theory.md sections 2.1, 9.3
#if defined(HEXAPLAST_ELASTIC_ASSUMED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELASTIC_ASSUMED_INL
#undef HEXAPLAST_ELASTIC_ASSUMED_INL
#else
#define HEXAPLAST_ELASTIC_ASSUMED_INL
#endif

#include "elastic/coefficients-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Columns of a sample become what acts on them: C dP R^T, with Z = columns^T C and dP R^T = 2 mu sym Z + free tr(Z) I;
/// one row of C at a time, so that nothing leaves the registers.
template <int kStride, class V, class Coef>
HEXAPLAST_INLINE void apply_sample(const Coef* C, V mu, V free, Mat<V>& columns) {
  Sym<V> Z;  // twice, off the diagonal
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    const V c[3] = {load_as(C + 3 * n * kStride), load_as(C + (3 * n + 1) * kStride),
                    load_as(C + (3 * n + 2) * kStride)};
    const V* const u = columns.m[n];
    const auto add = [&](V & to, int i, int k) __attribute__((always_inline)) {
      to = n == 0 ? u[i] * c[k] : to + u[i] * c[k];
    };
    add(Z.xx, 0, 0);
    add(Z.yy, 1, 1);
    add(Z.zz, 2, 2);
    add(Z.yz, 1, 2);
    add(Z.zx, 2, 0);
    add(Z.xy, 0, 1);
    Z.yz += u[2] * c[1];
    Z.zx += u[0] * c[2];
    Z.xy += u[1] * c[0];
  });
  const V pressure = free * (Z.xx + Z.yy + Z.zz), twice = mu + mu;
  const Sym<V> P{
      twice * Z.xx + pressure, twice * Z.yy + pressure, twice * Z.zz + pressure, mu * Z.yz, mu * Z.zx, mu * Z.xy};
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    const V c[3] = {load_as(C + 3 * n * kStride), load_as(C + (3 * n + 1) * kStride),
                    load_as(C + (3 * n + 2) * kStride)};
    columns.m[n][0] = c[0] * P.xx + c[1] * P.xy + c[2] * P.zx;
    columns.m[n][1] = c[0] * P.xy + c[1] * P.yy + c[2] * P.yz;
    columns.m[n][2] = c[0] * P.zx + c[1] * P.yz + c[2] * P.zz;
  });
}

/// u <- L u
template <int kStride, bool kHasLaw, class V, class Coef>
HEXAPLAST_INLINE void apply_assumed(const Coef* coef, const StiffnessKind& kind, const ScalarOf<V>* weight, V factor,
                                    CornerLanes<V>& u) {
  using T = ScalarOf<V>;
  using Places = CoefficientPlaces<false, Assumed::kCorner>;
  const Coef* const of_volume = coef + Places::kCount * kStride;
  const Coef* const of_mean = of_volume + kGradientCoefficients * kStride;  // of the corotated law
  const Coef* const of_law = of_mean;                                       // of the others
  // four times the mean edges and the hourglass modes
  const V sixteenth(T(1.0 / 16));
  V mu = sixteenth * factor * load(weight);
  const V lambda = sixteenth * factor * load(weight + kStride);
  V free = free_modulus(mu, lambda);
  const V all(static_cast<T>(16 * kCorners));  // samples weigh an eighth each
  ModeLanes<V> at;
  modes(u, at);
  const V along_volume = all * (kHasLaw ? lambda - free : lambda) * along_gradient<kStride>(of_volume, at);
  V along_mean(T(0));
  if constexpr (!kHasLaw) {
    const V of_branches = V(T(2.0 / 3)) * add_branch_modulus(kind, lambda, mu, free);
    along_mean = all * -(free + of_branches) * along_gradient<kStride>(of_mean, at);
  }

  const V corner_weight(static_cast<T>(kind.sampling.corner_weight));
  const Mat<V> j = load_mat<kStride, V>(coef + Places::kDirections * kStride);
  const AssumedLanes<V> how(j, corner_weight);
  V a[3][3];
  how.columns(at.at + 3, a);
  Mat<V> columns[kCorners];
  columns_of_modes(at.at, at.at + 3, a, corner_weight, columns);
  for (int i = 0; i < kCorners; ++i) {
    const Coef* const C = coef + (Places::kC + 9 * i) * kStride;
    if constexpr (kHasLaw) {
      const Mat<V> of_sample = load_mat<kStride, V>(C), Z = transposed_product(columns[i], of_sample);
      columns[i] = product_transposed(of_sample, law_increment<kStride>(of_law + 7 * i * kStride, Z, mu, free));
    } else {
      apply_sample<kStride>(C, mu, free, columns[i]);
    }
  }
  modes_of_columns(columns, corner_weight, a, at.at, at.at + 3);
  how.add_transpose(a, at.at + 3);
  add_gradient<kStride>(along_volume, of_volume, at);
  if constexpr (!kHasLaw) add_gradient<kStride>(along_mean, of_mean, at);
  modes_transpose(at, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
