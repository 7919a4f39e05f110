// SPDX-License-Identifier: LGPL-2.1-or-later
// The stiffness of one element per SIMD lane, by its coefficients.                             theory.md section 9.3
#if defined(HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#undef HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#else
#define HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#endif

#include "element/element-inl.hpp"
#include "state/element_operator.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// The type that Highway knows a stored coefficient by.
template <class Coef>
struct Stored {
  using type = Coef;
};
template <>
struct Stored<Half> {
  using type = hwy::float16_t;
};

template <class T, class Coef>
HWY_INLINE const typename Stored<Coef>::type* stored(const ElementOperator<T, Coef>& op, int block) {
  return reinterpret_cast<const typename Stored<Coef>::type*>(op.coef.data() + op.offset[block]);
}

// Coefficients as stored: [component][element], kStride elements.

template <int kStride, class V, class Coef>
HWY_INLINE Mat<V> load_mat(const Coef* from) {
  Mat<V> M;
  for (int k = 0; k < 9; ++k) M.m[k / 3][k % 3] = load_as(from + k * kStride);
  return M;
}
template <int kStride, class V, class Coef>
HWY_INLINE Mat<V> load_symmetric(const Coef* from) {
  return matrix(Sym<V>{load_as(from), load_as(from + kStride), load_as(from + 2 * kStride), load_as(from + 3 * kStride),
                       load_as(from + 4 * kStride), load_as(from + 5 * kStride)});
}
template <int kStride, class V, class Coef>
HWY_INLINE void load_corners(const Coef* from, CornerLanes<V>& corners) {
  for (int a = 0; a < kCorners; ++a)
    for (int j = 0; j < 3; ++j) corners.at[a][j] = load_as(from + (3 * a + j) * kStride);
}
template <int kStride, class V, class Coef>
HWY_INLINE void store_mat(const Mat<V>& M, V scale, Coef* to) {
  for (int k = 0; k < 9; ++k) store_as(M.m[k / 3][k % 3] * scale, to + k * kStride);
}
template <int kStride, class V, class Coef>
HWY_INLINE void store_corners(const CornerLanes<V>& corners, V scale, Coef* to) {
  for (int a = 0; a < kCorners; ++a)
    for (int j = 0; j < 3; ++j) store_as(corners.at[a][j] * scale, to + (3 * a + j) * kStride);
}

/// What grows with the stretch, within the numbers that a half can be.
template <class Coef, class V>
HWY_INLINE V bounded(V a) {
  if constexpr (!std::is_same_v<Coef, hwy::float16_t>) return a;
  constexpr double kLargest = 3e4;
  return min(max(a, V(-kLargest)), V(kLargest));
}

// Gradients at the corners whose sum is zero, without the last one: rounding them does not resist translation.

template <int kStride, class V, class Coef>
HWY_INLINE void store_gradient(const CornerLanes<V>& gradient, V scale, Coef* to) {
  unrolled<kGradientCoefficients>([&](auto k) __attribute__((always_inline)) {
    store_as(bounded<Coef>(gradient.at[k / 3][k % 3] * scale), to + k * kStride);
  });
}
/// gradient . u
template <int kStride, class V, class Coef>
HWY_INLINE V along_gradient(const Coef* gradient, const CornerLanes<V>& u) {
  const auto& last = u.at[kCorners - 1];
  V sum[3];  // not one chain
  for (int i = 0; i < 3; ++i) sum[i] = load_as(gradient + i * kStride) * (u.at[0][i] - last[i]);
  unrolled<kGradientCoefficients - 3>([&](auto n) __attribute__((always_inline)) {
    constexpr int k = n + 3;
    sum[k % 3] += load_as(gradient + k * kStride) * (u.at[k / 3][k % 3] - last[k % 3]);
  });
  return sum[0] + sum[1] + sum[2];
}
/// u += factor gradient
template <int kStride, class V, class Coef>
HWY_INLINE void add_gradient(V factor, const Coef* gradient, CornerLanes<V>& u) {
  V sum[3];
  unrolled<kGradientCoefficients>([&](auto k) __attribute__((always_inline)) {
    const V part = factor * load_as(gradient + k * kStride);
    u.at[k / 3][k % 3] += part;
    sum[k % 3] = k < 3 ? part : sum[k % 3] + part;
  });
  for (int i = 0; i < 3; ++i) u.at[kCorners - 1][i] -= sum[i];
}

/// Stores the coefficients of an element: those of its samples one after the other, then those of its shape.
template <int kStride, bool kGeneral, Assumed kAssumed, class V, class Coef>
class CoefficientWriter {
 public:
  using Element = ElementLanes<kGeneral, kAssumed, V>;

  HWY_INLINE CoefficientWriter(const Element& element, const StiffnessKind& kind, V length, Coef* coef)
      : element_(element),
        length_(length),
        coef_(coef),
        has_volume_(kind.has_volume()),
        has_mean_(kind.has_mean()),
        has_law_(kind.has_law()),
        of_law_(coef + (Places::kCount + (has_volume_ + has_mean_) * kGradientCoefficients) * kStride) {}

  HWY_INLINE void add_sample(int i, const MaterialLanes<V>& of, const PressureLanes<V>& p) {
    const auto& [R, S, doubtful] = element_.polar[i];
    const Mat<V>& inverse = inverse_at(element_.rest, i);
    const Mat<V> C = product_transposed(inverse, R);
    store_mat<kStride>(C, length_, coef_ + (Places::kC + 9 * i) * kStride);
    if constexpr (Places::kAtCorners) store_mat<kStride>(R, V(1.0), coef_ + (Places::kRotation + 9 * i) * kStride);
    if (has_law_) {
      const Mat<V> cof = R * matrix(cofactor(S));
      if (has_mean_) {
        dilatations_.add_columns(i, product_transposed(inverse, cof));
        if constexpr (Places::kAtCorners) dilatations_.add_shared(i, cof);
      }
      const Mat<V> G = product_transposed(cof, R);
      const V k = p.in_stress_at(dilatation(of.law, S));
      const V numbers[7] = {G(0, 0),
                            G(1, 1),
                            G(2, 2),
                            G(1, 2),
                            G(2, 0),
                            G(0, 1),
                            tangent_guard(of.law, of.mooney_share, S, of.mu, k) / max(of.mu, V(1e-30))};
      for (int n = 0; n < 7; ++n) store_as(bounded<Coef>(numbers[n]), of_law_ + (7 * i + n) * kStride);
    } else if (has_mean_) {
      dilatations_.add_columns(i, C);
      if constexpr (Places::kAtCorners) dilatations_.add_shared(i, R);
    }
  }

  /// of_volume: dV/dx of the world shape, read for the volume ratio only.
  HWY_INLINE void finish(const CornerLanes<V>& of_volume) {
    const auto& rest = element_.rest;
    Coef* to = coef_;
    if constexpr (Places::kAtCorners) store_corners<kStride>(rest.h, length_, to + Places::kShared * kStride);
    if constexpr (Places::kAssumes) store_mat<kStride>(element_.j, length_, to + Places::kDirections * kStride);
    if constexpr (Places::kHasMean) {
      store_corners<kStride>(rest.mean, V(1.0), to + Places::kMean * kStride);
      constexpr int kNumbers = Places::kDual - Places::kSkew;
      for (int k = 0; k < kNumbers; ++k) store_as(rest.skew[k / 3][k % 3], to + (Places::kSkew + k) * kStride);
      if constexpr (Places::kAtCorners) store_mat<kStride>(rest.dual, length_, to + Places::kDual * kStride);
    }
    to += Places::kCount * kStride;
    if (has_volume_) {
      store_gradient<kStride>(of_volume, length_ / rest.volume, to);
      to += kGradientCoefficients * kStride;
    }
    if (has_mean_) {
      CornerLanes<V> mean;
      if constexpr (Places::kAssumes) dilatations_.take_assumed(rest, AssumedLanes<V>(element_.j, rest.share));
      dilatations_.finish(rest, nullptr, One(), mean);
      store_gradient<kStride>(mean, V(1.0 / kCorners) * length_, to);
    }
  }

 private:
  using Places = CoefficientPlaces<kGeneral, kAssumed>;

  const Element& element_;
  V length_;
  Coef* coef_;
  bool has_volume_, has_mean_, has_law_;
  Coef* of_law_;
  ColumnsTranspose<kGeneral, kAssumed, V> dilatations_;  // of all samples
};

template <int kStride, bool kGeneral, class V, class Coef>
HWY_NOINLINE void store_one_rotation(const ElementLanes<kGeneral, Assumed::kModes, V>& element, Volumetric volumetric,
                                     const CornerLanes<V>& of_volume, V length, Coef* coef) {
  using Places = OneRotationPlaces<kGeneral>;
  const V one(1.0);
  store_mat<kStride>(element.j, length, coef + Places::kDirections * kStride);
  if constexpr (kGeneral) {
    store_corners<kStride>(element.rest.mean, one, coef + Places::kMean * kStride);
    for (int k = 0; k < 12; ++k) store_as(element.rest.skew[k / 3][k % 3], coef + (Places::kSkew + k) * kStride);
  }
  if (volumetric == Volumetric::kVolumeRatio)
    store_gradient<kStride>(of_volume, length / element.rest.volume, coef + Places::kCount * kStride);
}

/// u <- L u of elements with one rotation: the mean gradient, the parts of the samples' gradients that are linear in
/// one coordinate, and those bilinear in two do no work on one another.                                          eq.
/// E28
template <int kStride, bool kGeneral, class V, class Coef>
HWY_INLINE void apply_one_rotation(const Coef* coef, const StiffnessKind& kind, const typename V::Scalar* weight,
                                   V factor, CornerLanes<V>& u) {
  using T = typename V::Scalar;
  using Places = OneRotationPlaces<kGeneral>;
  RestLanes<kGeneral, Assumed::kModes, V> rest;
  rest.share = V(static_cast<T>(kind.sampling.share));
  if constexpr (kGeneral) {
    load_corners<kStride>(coef + Places::kMean * kStride, rest.mean);
    for (int k = 0; k < 12; ++k) rest.skew[k / 3][k % 3] = load_as(coef + (Places::kSkew + k) * kStride);
  }
  ColumnLanes<kGeneral, Assumed::kModes, V> columns;
  begin_columns(rest, u, columns);
  const Mat<V> j = load_mat<kStride, V>(coef + Places::kDirections * kStride);
  const AssumedLanes<V> how(j, rest.share);
  how.columns(columns.Q, columns.a);

  const V all(static_cast<T>(kCorners));  // samples weigh an eighth each
  const V mu = all * factor * load(weight), lambda = all * factor * load(weight + kStride);
  const V free = free_modulus(kind.volumetric, mu, lambda);
  const Coef* const of_volume = coef + Places::kCount * kStride;
  V along_volume(T(0));
  if (kind.has_volume()) along_volume = lambda * along_gradient<kStride>(of_volume, u);

  const V of_mean = kind.has_volume() ? V(T(0)) : lambda;
  Mat<V> mean = product_transposed(j, stress_increment(transposed_product(columns.mean, j), mu, of_mean));

  V acting[3][3], on_modes[4][3];
  unrolled<3>([&](auto k) __attribute__((always_inline)) {
    Mat<V> rows;  // what the coordinate k has in column n
    for (int n = 0; n < 3; ++n)
      for (int i = 0; i < 3; ++i) rows(n, i) = n == k ? columns.a[k][i] : rest.share * columns.Q[3 - k - n][i];
    const Mat<V> out = product_transposed(j, stress_increment(transposed_product(rows, j), mu, free));
    for (int n = 0; n < 3; ++n)
      for (int i = 0; i < 3; ++i) {
        if (n == k) {
          acting[k][i] = out(n, i);
        } else {  // each mode has part in two coordinates
          V& to = on_modes[3 - k - n][i];
          const V part = rest.share * out(n, i);
          to = k < n ? part : to + part;
        }
      }
  });
  const auto& Q = columns.Q[3];
  V lengths(T(0)), sum[3] = {V(T(0)), V(T(0)), V(T(0))};
  for (int n = 0; n < 3; ++n) {
    lengths += j(n, 0) * j(n, 0) + j(n, 1) * j(n, 1) + j(n, 2) * j(n, 2);
    const V along = Q[0] * j(n, 0) + Q[1] * j(n, 1) + Q[2] * j(n, 2);
    for (int i = 0; i < 3; ++i) sum[i] += along * j(n, i);
  }
  const V squared(T(kFourthShare * kFourthShare));
  for (int i = 0; i < 3; ++i) on_modes[3][i] = squared * (mu * lengths * Q[i] + (mu + free) * sum[i]);
  how.add_transpose(acting, on_modes);

  EdgeLanes<V> e;
  set_zero(e);
  set_zero(u);
  if constexpr (kGeneral) {
    for (int l = 0; l < 4; ++l)
      for (int n = 0; n < 3; ++n)
        for (int i = 0; i < 3; ++i) mean(n, i) -= rest.skew[l][n] * on_modes[l][i];
    for (int c = 0; c < kCorners; ++c)
      for (int i = 0; i < 3; ++i)
        u.at[c][i] =
            rest.mean.at[c][0] * mean(0, i) + rest.mean.at[c][1] * mean(1, i) + rest.mean.at[c][2] * mean(2, i);
  } else {
    for (int d = 0; d < 3; ++d)
      for (int i = 0; i < 3; ++i) {
        const V quarter = V(T(0.25)) * mean(d, i);
        for (int m = 0; m < 4; ++m) e.at[d][m][i] = quarter;
      }
  }
  add_hourglass_transpose(on_modes, e);
  add_edges_transpose(e, u);
  if (kind.has_volume()) add_gradient<kStride>(along_volume, of_volume, u);
}

/// u <- L u, L = - df/dx with the rotations held fixed.
///
///   Z_i = dF~_i R_i^T,   dP_i R_i^T = 2 mu sym Z_i + (lambda_f t_i + shared) I,   t_i = tr Z_i              eq. 52, E4
///
/// kUnrolls: the loop over samples is unrolled, which is faster by a quarter and takes the compiler much longer.
///
/// With C_i = J_i^-1 R_i^T the rotation costs nothing on parallelepipeds: Z_i = (columns at i) C_i. For the other laws
/// G_i = R_i cof(S_i) R_i^T stands for I, also in t_i = G_i : Z_i, and beta_i Z_i is added.                   eq. E20
template <int kStride, bool kGeneral, Assumed kAssumed, bool kPerSample, bool kHasLaw, bool kUnrolls, class V,
          class Coef>
HWY_INLINE void apply_stiffness(const Coef* coef, const StiffnessKind& kind, const typename V::Scalar* weight, V factor,
                                CornerLanes<V>& u) {
  using T = typename V::Scalar;
  using Places = CoefficientPlaces<kGeneral, kAssumed>;
  RestLanes<kGeneral, kAssumed, V> rest;
  rest.share = V(static_cast<T>(kind.sampling.share));
  if constexpr (Places::kAtCorners) load_corners<kStride>(coef + Places::kShared * kStride, rest.h);
  if constexpr (Places::kHasMean) {
    load_corners<kStride>(coef + Places::kMean * kStride, rest.mean);
    constexpr int kNumbers = Places::kDual - Places::kSkew;
    for (int k = 0; k < kNumbers; ++k) rest.skew[k / 3][k % 3] = load_as(coef + (Places::kSkew + k) * kStride);
    if constexpr (Places::kAtCorners) rest.dual = load_mat<kStride, V>(coef + Places::kDual * kStride);
  }
  ColumnLanes<kGeneral, kAssumed, V> columns;
  begin_columns(rest, u, columns);
  Mat<V> j;
  if constexpr (Places::kAssumes) j = load_mat<kStride, V>(coef + Places::kDirections * kStride);
  const auto how = [&] {
    if constexpr (Places::kAssumes)
      return AssumedLanes<V>(j, rest.share);
    else
      return nullptr;
  }();
  finish_columns(rest, u, how, columns);

  V mu = factor * load(weight), lambda = factor * load(weight + kStride);
  V free = lambda, along_volume(T(0)), along_mean(T(0));
  const bool has_volume = !kPerSample && kind.has_volume(), has_mean = !kPerSample && kind.has_mean();
  const Coef* const of_volume = coef + Places::kCount * kStride;
  const Coef* const of_mean = of_volume + (has_volume ? kGradientCoefficients : 0) * kStride;
  const Coef* const of_law = of_mean + (has_mean ? kGradientCoefficients : 0) * kStride;
  if constexpr (!kPerSample) {
    free = free_modulus(kind.volumetric, mu, lambda);
    const V all(static_cast<T>(kCorners));  // samples weigh an eighth each
    if (has_volume) along_volume = all * (kHasLaw ? lambda - free : lambda) * along_gradient<kStride>(of_volume, u);
    if (has_mean) along_mean = all * (has_volume ? -free : lambda - free) * along_gradient<kStride>(of_mean, u);
  }

  ColumnsTranspose<kGeneral, kAssumed, V> acting;
  const auto sample = [&](auto i) __attribute__((always_inline)) {
    if constexpr (kPerSample) {
      mu = factor * load(weight + 2 * i * kStride);
      free = factor * load(weight + (2 * i + 1) * kStride);
    }
    const Mat<V> C = load_mat<kStride, V>(coef + (Places::kC + 9 * i) * kStride);
    Mat<V> Z = transposed_product(columns_at(columns, i), C), R;
    if constexpr (Places::kAtCorners) {
      R = load_mat<kStride, V>(coef + (Places::kRotation + 9 * i) * kStride);
      const Mat<V> H = shared_at(columns, i);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) Z(r, c) += H(r, 0) * R(c, 0) + H(r, 1) * R(c, 1) + H(r, 2) * R(c, 2);
    }
    Mat<V> P;  // dP R^T
    if constexpr (kHasLaw) {
      const Mat<V> G = load_symmetric<kStride, V>(of_law + 7 * i * kStride);
      const V pressure = free * dot(G, Z), beta = mu * load_as(of_law + (7 * i + 6) * kStride);
      P = stress_increment(Z, mu, V(T(0)));
      for (int k = 0; k < 9; ++k) P.m[k / 3][k % 3] += pressure * G.m[k / 3][k % 3] + beta * Z.m[k / 3][k % 3];
    } else {
      P = stress_increment(Z, mu, free);
    }
    acting.add_columns(i, product_transposed(C, P));  // rows
    if constexpr (Places::kAtCorners) acting.add_shared(i, P * R);
  };
  if constexpr (kUnrolls)
    unrolled<kCorners>(sample);
  else
    for (int i = 0; i < kCorners; ++i) sample(i);
  acting.take_assumed(rest, how);
  acting.finish(rest, nullptr, One(), u);
  if (has_volume) add_gradient<kStride>(along_volume, of_volume, u);
  if (has_mean) add_gradient<kStride>(along_mean, of_mean, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
