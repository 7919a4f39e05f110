// SPDX-License-Identifier: LGPL-2.1-or-later
// The stiffness of parallelepipeds with one rotation: of their modes, no samples.               theory.md section 9.3
#if defined(HEXAPLAST_ELASTIC_ONE_ROTATION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELASTIC_ONE_ROTATION_INL
#undef HEXAPLAST_ELASTIC_ONE_ROTATION_INL
#else
#define HEXAPLAST_ELASTIC_ONE_ROTATION_INL
#endif

#include "elastic/coefficients-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Lower triangle of a square matrix, column by column.
template <int kSize, class N>
struct LowerLanes {
  static constexpr int kCount = kSize * (kSize + 1) / 2;
  static constexpr int place(int row, int column) { return column * (2 * kSize - 1 - column) / 2 + row; }
  HEXAPLAST_INLINE N& operator()(int row, int column) { return at[place(row, column)]; }
  HEXAPLAST_INLINE const N& operator()(int row, int column) const { return at[place(row, column)]; }

  N at[kCount];
};

/// A symmetric matrix A becomes its factor: A = L L^T.
template <int kSize, class N>
HEXAPLAST_INLINE void factorize(LowerLanes<kSize, N>& A) {
  using T = ScalarOf<N>;
  unrolled<kSize>([&](auto c) __attribute__((always_inline)) {
    N column[kSize - c];
    for (int n = 0; n < kSize - c; ++n) column[n] = A(c + n, c);
    const N lowest = max(N(T(1e-6)) * column[0], N(T(1e-30)));  // also of elements that are not there
    unrolled<c>([&](auto k) __attribute__((always_inline)) {
      const N factor = A(c, k);
      for (int n = 0; n < kSize - c; ++n) column[n] -= A(c + n, k) * factor;
    });
    A(c, c) = sqrt(max(column[0], lowest));
    const N inverse = N(T(1)) / A(c, c);
    for (int n = 1; n < kSize - c; ++n) A(c + n, c) = inverse * column[n];
  });
}

/// u <- weight L L^T u of a stored factor: rounded, it is still one of a positive matrix.
template <int kSize, int kStride, class V, class Coef>
HEXAPLAST_INLINE void apply_factor(StoredNumbers<LowerLanes<kSize, V>::kCount, kStride, Coef> from, V weight,
                                   V (*u)[3]) {
  V sum[kSize];
  unrolled<kSize>([&](auto c) __attribute__((always_inline)) {
    constexpr int kRows = kSize - c;
    V L[kRows];
    for (int n = 0; n < kRows; ++n) L[n] = load_as(from[LowerLanes<kSize, V>::place(c + n, c)]);
    V along = L[0] * u[c / 3][c % 3];
    for (int n = 1; n < kRows; ++n) along += L[n] * u[(c + n) / 3][(c + n) % 3];
    along *= weight;
    for (int n = 0; n < kRows; ++n) sum[c + n] = c == 0 ? L[n] * along : sum[c + n] + L[n] * along;
  });
  for (int k = 0; k < kSize; ++k) u[k / 3][k % 3] = sum[k];
}

/// The stiffness of the hourglass modes Q over mu + lambda_f, of all samples of an element together: constant but for
/// the rotation that j has. In the plane across j_n, the strain that is linear in s_n is
///
///   corner_weight sym(Q_l (x) p_l + Q_m (x) p_m),   p_l = j_m - al_nm j_n,   p_m = j_l - al_nl j_n eq. E29
template <class N>
struct ModeStiffness {
  LowerLanes<9, N> of_two;
  LowerLanes<3, N> of_three;

  HEXAPLAST_NOINLINE ModeStiffness(const Mat<N>& j, double corner_weight, N mu, N free) {
    using T = ScalarOf<N>;
    const N one(T(1)), whole = one / max(mu + free, N(T(1e-30)));  // nothing where nothing is
    const N squared = N(T(corner_weight)) * N(T(corner_weight)) * whole, of_mu = squared * mu, of_free = squared * free;
    N lengths(T(0));
    unrolled<3>([&](auto n) __attribute__((always_inline)) {
      constexpr int m = n == 0 ? 1 : 0, l = 3 - n - m;
      const N* const normal = j.m[n];
      const N square = dot(normal, normal), inverse = one / square;
      const N al_m = dot(normal, j.m[m]) * inverse, al_l = dot(normal, j.m[l]) * inverse;
      N of_l[3], of_m[3], mu_l[3], mu_m[3], free_l[3], free_m[3];
      for (int i = 0; i < 3; ++i) {
        of_l[i] = j(m, i) - al_m * normal[i];
        of_m[i] = j(l, i) - al_l * normal[i];
        mu_l[i] = of_mu * of_l[i];
        mu_m[i] = of_mu * of_m[i];
        free_l[i] = of_free * of_l[i];
        free_m[i] = of_free * of_m[i];
      }
      const N ll = dot(mu_l, of_l), mm = dot(mu_m, of_m), lm = dot(mu_l, of_m);
      for (int i = 0; i < 3; ++i) {
        const N both_l = mu_l[i] + free_l[i], both_m = mu_m[i] + free_m[i], turned = inverse * normal[i];
        for (int k = 0; k < 3; ++k) {
          const N plane = i == k ? one - turned * normal[k] : -(turned * normal[k]);
          of_two(3 * l + i, 3 * m + k) = lm * plane + mu_m[i] * of_l[k] + free_l[i] * of_m[k];
          if (k > i) continue;
          const N on_l = ll * plane + both_l * of_l[k], on_m = mm * plane + both_m * of_m[k];
          N &to_l = of_two(3 * l + i, 3 * l + k), &to_m = of_two(3 * m + i, 3 * m + k);
          to_l = n == 0 ? on_l : to_l + on_l;  // the modes 1 and 2 come first with n = 0, the mode 0 with n = 1
          to_m = n == 2 ? to_m + on_m : on_m;
        }
      }
      lengths += square;
    });
    const N fourth(T(corner_weight * corner_weight)), of_lengths = fourth * whole * mu * lengths;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k <= i; ++k) {
        const N sum = fourth * (j(0, i) * j(0, k) + j(1, i) * j(1, k) + j(2, i) * j(2, k));
        of_three(i, k) = i == k ? sum + of_lengths : sum;
      }
  }
};

/// Stores an element whose rotation is known; j: its directions, in units of `length`. The stiffness of its modes
/// becomes its factor.
template <int kStride, class V, class Coef>
HEXAPLAST_NOINLINE void store_one_rotation(const RestLanes<false, V>& rest, const Mat<V>& j,
                                           ModeStiffness<V>& stiffness, const ModeLanes<V>& of_volume, V length,
                                           StoredOneRotation<Coef, kStride> to) {
  factorize(stiffness.of_two);
  factorize(stiffness.of_three);
  store_mat(j, V(ScalarOf<V>(1)), to.directions());
  for (int k = 0; k < stiffness.of_two.kCount; ++k) store_as(stiffness.of_two.at[k], to.of_two()[k]);
  for (int k = 0; k < stiffness.of_three.kCount; ++k) store_as(stiffness.of_three.at[k], to.of_three()[k]);
  store_gradient(of_volume, length / rest.volume, to.volume_gradient());
}

/// u <- factor L u: the mean gradient, the modes of two coordinates and that of three do no work on one another.
///                                                                                                          eq. E29
template <bool kHasLaw, int kStride, class V, class Coef>
HEXAPLAST_INLINE void apply_stiffness(const StoredOneRotation<Coef, kStride>& element, const StiffnessKind& kind,
                                      StoredNumbers<2, kStride, const ScalarOf<V>> weight, V factor,
                                      CornerLanes<V>& u) {
  static_assert(!kHasLaw);
  using T = ScalarOf<V>;
  // four times the mean edges and the hourglass modes, and eight samples that weigh an eighth each: 8 / 4 / 4
  const V half = V(T(0.5)) * factor;
  const ElementModuli<V> of(kind, kHasLaw, half * load(weight[0]), half * load(weight[1]));
  const V whole = of.mu + of.free;
  ModeLanes<V> at;
  modes(u, at);
  const V along_volume = V(T(2 * kCorners)) * of.of_ratio * along_gradient(element.volume_gradient(), at);

  const Mat<V> j = load_mat<V>(element.directions());
  Mat<V> mean;
  for (int n = 0; n < 3; ++n)
    for (int i = 0; i < 3; ++i) mean(n, i) = at.at[n][i];
  const Mat<V> P = stress_increment(transposed_product(mean, j), of.mu, -of.bulk);
  const Mat<V> acting = product_transposed(j, P);
  for (int n = 0; n < 3; ++n)
    for (int i = 0; i < 3; ++i) at.at[n][i] = acting(n, i);
  apply_factor<9>(element.of_two(), whole, at.at + 3);
  apply_factor<3>(element.of_three(), whole, at.at + 6);

  add_gradient(along_volume, element.volume_gradient(), at);
  modes_transpose(at, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
