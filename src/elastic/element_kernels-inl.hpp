// SPDX-License-Identifier: LGPL-2.1-or-later
// Force and stiffness of one element per SIMD lane.                                            theory.md section 9.3
#if defined(HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#undef HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#else
#define HEXAPLAST_ELASTIC_ELEMENT_KERNELS_INL
#endif

#include "kinematics/gradients-inl.hpp"
#include "material/corotated-inl.hpp"
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

/// Coefficients of one sample, as stored: nine numbers, [component][element of the block].
template <class V, class Coef>
HWY_INLINE Mat<V> load_mat(const Coef* from) {
  Mat<V> M;
  for (int k = 0; k < 9; ++k) M.m[k / 3][k % 3] = load_as(from + k * kBlock);
  return M;
}
template <class V>
HWY_INLINE void store_mat(const Mat<V>& M, V scale, double* to) {
  for (int k = 0; k < 9; ++k) store(M.m[k / 3][k % 3] * scale, to + k * kBlock);
}
template <class V>
HWY_INLINE void store_mat(const Mat<V>& M, V scale, float* to) {
  for (int k = 0; k < 9; ++k) store_as(M.m[k / 3][k % 3] * scale, to + k * kBlock);
}
template <class V>
HWY_INLINE void store_mat(const Mat<V>& M, V scale, hwy::float16_t* to) {
  for (int k = 0; k < 9; ++k) store_as(M.m[k / 3][k % 3] * scale, to + k * kBlock);
}

/// Whether a corner has a smaller number than the other end of its edge of direction d.
template <int kCorner, int kDirection>
constexpr bool comes_first() {
  return kCorner < kEdgeNeighbour[kCorner][kDirection];
}

/// u <- L u, L = - df/dx with the rotations held fixed, of elements with a coefficient layout of kind kGeneral or not.
///
///   Z_i = dF~_i R_i^T,   dP_i R_i^T = 2 mu sym Z_i + lambda tr(Z_i) I                                       eq. 52
///
/// With C_i = J_i^-1 R_i^T the rotation costs nothing on parallelepipeds: Z_i = (blended edges at i) C_i.
template <bool kGeneral, bool kPerSample, class V, class Coef>
HWY_INLINE void apply_stiffness(const Coef* coef, const typename V::Scalar* weight, V share, V factor,
                                CornerLanes<V>& u) {
  using T = typename V::Scalar;
  EdgeLanes<V> e, q;
  edges(u, e);
  Mat<V> H, Q;
  const Coef* rotation = coef + 9 * kCorners * kBlock;
  const Coef* shared = rotation + 9 * kCorners * kBlock;
  if constexpr (kGeneral) {
    CornerLanes<V> h;
    for (int a = 0; a < kCorners; ++a)
      for (int j = 0; j < 3; ++j) h.at[a][j] = load_as(shared + (3 * a + j) * kBlock);
    H = outer_sum(u, h);
    for (int k = 0; k < 9; ++k) Q.m[k / 3][k % 3] = V(T(0));
    scale(share, e);
  } else {
    blend(share, e);
  }

  V mu = factor * load(weight), lambda = factor * load(weight + kBlock);
  unrolled<kCorners>([&](auto i) __attribute__((always_inline)) {
    if constexpr (kPerSample) {
      mu = factor * load(weight + 2 * i * kBlock);
      lambda = factor * load(weight + (2 * i + 1) * kBlock);
    }
    const Mat<V> C = load_mat<V>(coef + 9 * i * kBlock);
    Mat<V> Z, R;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        Z(r, c) = e.at[0][kEdgeAt[i][0]][r] * C(0, c) + e.at[1][kEdgeAt[i][1]][r] * C(1, c) +
                  e.at[2][kEdgeAt[i][2]][r] * C(2, c);
    if constexpr (kGeneral) {
      R = load_mat<V>(rotation + 9 * i * kBlock);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) Z(r, c) += H(r, 0) * R(c, 0) + H(r, 1) * R(c, 1) + H(r, 2) * R(c, 2);
    }
    const Mat<V> P = stress_increment(Z, mu, lambda);  // dP R^T
    unrolled<3>([&](auto d) __attribute__((always_inline)) {
      for (int r = 0; r < 3; ++r) {
        V& to = q.at[d][kEdgeAt[i][d]][r];
        const V part = P(r, 0) * C(d, 0) + P(r, 1) * C(d, 1) + P(r, 2) * C(d, 2);
        to = comes_first<i, d>() ? part : to + part;
      }
    });
    if constexpr (kGeneral)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) Q(r, c) += P(r, 0) * R(0, c) + P(r, 1) * R(1, c) + P(r, 2) * R(2, c);
  });

  if constexpr (kGeneral) {
    for (int a = 0; a < kCorners; ++a)
      for (int r = 0; r < 3; ++r) {
        u.at[a][r] = Q(r, 0) * load_as(shared + (3 * a) * kBlock) + Q(r, 1) * load_as(shared + (3 * a + 1) * kBlock) +
                     Q(r, 2) * load_as(shared + (3 * a + 2) * kBlock);
      }
    scale(share, q);
  } else {
    set_zero(u);
    blend(share, q);
  }
  add_edges_transpose(q, u);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
