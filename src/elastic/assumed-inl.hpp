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
HEXAPLAST_INLINE void apply_sample(StoredNumbers<9, kStride, Coef> C, V mu, V free, Mat<V>& columns) {
  Sym<V> Z;  // twice, off the diagonal
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    const V c[3] = {load_as(C[3 * n]), load_as(C[3 * n + 1]), load_as(C[3 * n + 2])};
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
    const V c[3] = {load_as(C[3 * n]), load_as(C[3 * n + 1]), load_as(C[3 * n + 2])};
    columns.m[n][0] = c[0] * P.xx + c[1] * P.xy + c[2] * P.zx;
    columns.m[n][1] = c[0] * P.xy + c[1] * P.yy + c[2] * P.yz;
    columns.m[n][2] = c[0] * P.zx + c[1] * P.yz + c[2] * P.zz;
  });
}

/// u <- factor L u of a parallelepiped.
template <bool kHasLaw, int kStride, class V, class Coef>
HEXAPLAST_INLINE void apply_stiffness(const StoredElement<false, Coef, kStride>& element, const StiffnessKind& kind,
                                      StoredNumbers<2, kStride, const ScalarOf<V>> weight, V factor,
                                      CornerLanes<V>& u) {
  using T = ScalarOf<V>;
  const V sixteenth(T(1.0 / 16));  // four times the mean edges and the hourglass modes
  const ElementModuli<V> of(kind, kHasLaw, sixteenth * factor * load(weight[0]), sixteenth * factor * load(weight[1]));
  const V all(static_cast<T>(16 * kCorners));  // samples weigh an eighth each
  ModeLanes<V> at;
  modes(u, at);
  const V along_volume = all * of.of_ratio * along_gradient(element.volume_gradient(), at);
  V along_mean(T(0));
  if constexpr (!kHasLaw) along_mean = all * of.of_mean() * along_gradient(element.mean_gradient(), at);

  const V corner_weight(static_cast<T>(kind.sampling.corner_weight));
  const Mat<V> j = load_mat<V>(element.directions());
  const AssumedLanes<V> how(j, corner_weight);
  V a[3][3];
  how.columns(at.at + 3, a);
  Mat<V> columns[kCorners];
  columns_of_modes(at.at, at.at + 3, a, corner_weight, columns);
  for (int i = 0; i < kCorners; ++i) {
    if constexpr (kHasLaw) {
      const Mat<V> C = load_mat<V>(element.C(i)), Z = transposed_product(columns[i], C);
      columns[i] = product_transposed(C, LawLanes<V>(element.law(i)).increment(Z, of.mu, of.free));
    } else {
      apply_sample(element.C(i), of.mu, of.free, columns[i]);
    }
  }
  modes_of_columns(columns, corner_weight, a, at.at, at.at + 3);
  how.add_transpose(a, at.at + 3);
  add_gradient(along_volume, element.volume_gradient(), at);
  if constexpr (!kHasLaw) add_gradient(along_mean, element.mean_gradient(), at);
  modes_transpose(at, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
