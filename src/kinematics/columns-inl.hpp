// SPDX-License-Identifier: LGPL-2.1-or-later
// From nodal values to the columns of the samples of a hexahedron, and the transpose.         theory.md sections 2, 2.1
#if defined(HEXAPLAST_KINEMATICS_COLUMNS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_KINEMATICS_COLUMNS_INL
#undef HEXAPLAST_KINEMATICS_COLUMNS_INL
#else
#define HEXAPLAST_KINEMATICS_COLUMNS_INL
#endif

#include "kinematics/gradients-inl.hpp"
#include "kinematics/modes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// The assumed part of the samples: a_n, which is added to column n of 2 Jhat at s_n = 1 and taken away at s_n = -1, of
/// the hourglass modes Q; j: rows R_m J^n, of any length.                                                      eq. E10
///
///   a_n = -corner_weight sum_(m, l) [ al_nm Q_l + be_nl (j_m - al_nm j_n) ],  al_nm = j_n . j_m / j_n . j_n,
///                                                                     be_nl = Q_l . j_n / j_n . j_n
///
/// over the two (m, l) with n, m, l different.
template <class N>
class AssumedLanes {
 public:
  HEXAPLAST_INLINE AssumedLanes(const Mat<N>& rows, N corner_weight) : j_(rows) {  // which are to stay
    for (int n = 0; n < 3; ++n) {
      const N inverse = N(ScalarOf<N>(1)) / dot(j_.m[n], j_.m[n]);
      inverse_[n] = -(corner_weight * inverse);
      for (int k = 0; k < 2; ++k) {
        const int m = (n + 1 + k) % 3;
        const N al = dot(j_.m[n], j_.m[m]) * inverse;
        al_[n][k] = -(corner_weight * al);
        for (int i = 0; i < 3; ++i) across_[n][k][i] = j_(m, i) - al * j_(n, i);
      }
    }
  }

  HEXAPLAST_INLINE void columns(const N (*Q)[3], N (&a)[3][3]) const {
    for (int n = 0; n < 3; ++n)
      for (int k = 0; k < 2; ++k) {
        const N* const mode = Q[(n + 2 - k) % 3];
        const N be = dot(mode, j_.m[n]) * inverse_[n];
        for (int i = 0; i < 3; ++i) {
          const N part = al_[n][k] * mode[i] + be * across_[n][k][i];
          a[n][i] = k == 0 ? part : a[n][i] + part;
        }
      }
  }

  /// Q += the transpose of that, of what acts on the a_n.
  HEXAPLAST_INLINE void add_transpose(const N (&a)[3][3], N (*Q)[3]) const {
    for (int n = 0; n < 3; ++n)
      for (int k = 0; k < 2; ++k) {
        N* const mode = Q[(n + 2 - k) % 3];
        const N along = dot(a[n], across_[n][k]) * inverse_[n];
        for (int i = 0; i < 3; ++i) mode[i] += al_[n][k] * a[n][i] + along * j_(n, i);
      }
  }

 private:
  const Mat<N>& j_;
  N inverse_[3], al_[3][2];  ///< -corner_weight / j_n . j_n, -corner_weight al_nm
  N across_[3][2][3];        ///< j_m - al_nm j_n
};

/// Columns of the samples, from the mean, the hourglass modes and what is assumed: column n has
/// mean_n + s_m Q_l + s_l Q_m + s_m s_l Q_3 + s_n a_n, with corner_weight of the modes.
template <class N>
HEXAPLAST_INLINE void columns_of_modes(const N (*mean)[3], const N (*modes)[3], const N (&a)[3][3], N corner_weight,
                                       Mat<N>* columns) {
  N Q[4][3];
  for (int l = 0; l < 4; ++l)
    for (int i = 0; i < 3; ++i) Q[l][i] = corner_weight * modes[l][i];
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    constexpr int m = kOther[n][0], l = kOther[n][1];
    for (int i = 0; i < 3; ++i) {
      const N far = mean[n][i] + Q[l][i], near = mean[n][i] - Q[l][i];  // in coordinate m
      const N far_by_l = Q[m][i] + Q[3][i], near_by_l = Q[m][i] - Q[3][i];
      const N edge[4] = {near - near_by_l, far - far_by_l, near + near_by_l, far + far_by_l};
      for (int k = 0; k < 4; ++k) {
        columns[kEdgeFrom[n][k]](n, i) = edge[k] - a[n][i];
        columns[kEdgeTo[n][k]](n, i) = edge[k] + a[n][i];
      }
    }
  });
}
/// The transpose, of what acts on the columns.
template <class N>
HEXAPLAST_INLINE void modes_of_columns(const Mat<N>* columns, N corner_weight, N (&a)[3][3], N (*mean)[3],
                                       N (*modes)[3]) {
  N Q[4][3];
  unrolled<3>([&](auto n) __attribute__((always_inline)) {
    constexpr int m = kOther[n][0], l = kOther[n][1];
    for (int i = 0; i < 3; ++i) {
      N edge[4], along[4];
      for (int k = 0; k < 4; ++k) {
        const N from = columns[kEdgeFrom[n][k]](n, i), to = columns[kEdgeTo[n][k]](n, i);
        edge[k] = to + from;
        along[k] = to - from;
      }
      a[n][i] = (along[0] + along[1]) + (along[2] + along[3]);
      const N far = edge[3] + edge[1], near = edge[2] + edge[0];
      const N far_by_l = edge[3] - edge[1], near_by_l = edge[2] - edge[0];
      mean[n][i] = far + near;
      const N by_m = far - near, by_l = far_by_l + near_by_l, by_both = far_by_l - near_by_l;
      Q[l][i] = n == 0 ? by_m : Q[l][i] + by_m;
      Q[m][i] = n < 2 && m < 2 ? by_l : Q[m][i] + by_l;
      Q[3][i] = n == 0 ? by_both : Q[3][i] + by_both;
    }
  });
  for (int l = 0; l < 4; ++l)
    for (int i = 0; i < 3; ++i) modes[l][i] = corner_weight * Q[l][i];
}

/// Columns of 2 Jhat at the samples, as far as they are linear in nodal values once the rotation of the mean is held.
template <bool kGeneral, class N>
struct ColumnLanes {
  using Rest = RestLanes<kGeneral, N>;

  EdgeLanes<N> e;                            ///< by edges, unless by modes
  Mat<N> by_modes[kGeneral ? 1 : kCorners];  ///< rows, by sample
  N a[3][3];                                 ///< assumed: of sign s_n in column n
  Mat<N> H;                                  ///< where the inverses are those of corners: what all gradients share
  Mat<N> turned[3];                          ///< there: a_n (x) dual_n
  Mat<N> mean;                               ///< rows: F_m 2 J_o
  N Q[kGeneral ? 3 : 4][3];                  ///< hourglass modes
};

/// Mean columns and hourglass modes, which what is assumed needs.
template <bool kGeneral, class N>
HEXAPLAST_INLINE void begin_columns(const RestLanes<kGeneral, N>& rest, const CornerLanes<N>& u,
                                    ColumnLanes<kGeneral, N>& at) {
  if constexpr (!kGeneral) {
    const N quarter(ScalarOf<N>(0.25));
    ModeLanes<N> of;
    modes(u, of);
    for (int l = 0; l < 4; ++l)
      for (int i = 0; i < 3; ++i) at.Q[l][i] = quarter * of.at[3 + l][i];
    for (int n = 0; n < 3; ++n)
      for (int i = 0; i < 3; ++i) at.mean(n, i) = quarter * of.at[n][i];
  } else {
    edges(u, at.e);
    hourglass_modes(at.e, at.Q);
    for (int n = 0; n < 3; ++n)
      for (int i = 0; i < 3; ++i) {
        N sum = u.at[0][i] * rest.mean.at[0][n];
        for (int a = 1; a < kCorners; ++a) sum += u.at[a][i] * rest.mean.at[a][n];
        at.mean(n, i) = sum;
      }
    for (int l = 0; l < 3; ++l)
      for (int i = 0; i < 3; ++i)
        at.Q[l][i] -=
            rest.skew[l][0] * at.mean(0, i) + rest.skew[l][1] * at.mean(1, i) + rest.skew[l][2] * at.mean(2, i);
  }
}

template <bool kGeneral, class N>
HEXAPLAST_INLINE void finish_columns(const RestLanes<kGeneral, N>& rest, const CornerLanes<N>& u,
                                     const AssumedLanes<N>& assumed, ColumnLanes<kGeneral, N>& at) {
  assumed.columns(at.Q, at.a);
  if constexpr (!kGeneral) {
    columns_of_modes(at.mean.m, at.Q, at.a, rest.corner_weight, at.by_modes);
  } else {
    at.H = outer_sum(u, rest.h);
    scale(rest.corner_weight, at.e);
    for (int n = 0; n < 3; ++n)
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) at.turned[n](i, k) = at.a[n][i] * rest.dual(n, k);
  }
}

/// a + s b with s coordinate d of a corner in the reference cube, 1 or -1.
template <class N>
HEXAPLAST_INLINE N signed_sum(int corner, int d, N a, N b) {
  return a + N(static_cast<ScalarOf<N>>(kCornerSign[corner][d])) * b;
}

/// Rows: the columns at a sample, to be multiplied by its inverse.
template <bool kGeneral, class N>
HEXAPLAST_INLINE decltype(auto) columns_at(const ColumnLanes<kGeneral, N>& at, int sample) {
  if constexpr (!kGeneral)
    return (at.by_modes[sample]);
  else
    return edges_at(at.e, sample);
}
/// What is added to the gradient of a sample, where the inverses are those of corners.
template <bool kGeneral, class N>
HEXAPLAST_INLINE Mat<N> shared_at(const ColumnLanes<kGeneral, N>& at, int sample) {
  Mat<N> H = at.H;
  for (int n = 0; n < 3; ++n)
    for (int k = 0; k < 9; ++k)
      H.m[k / 3][k % 3] = signed_sum(sample, n, H.m[k / 3][k % 3], at.turned[n].m[k / 3][k % 3]);
  return H;
}

/// A factor of one that takes no multiplication.
struct One {
  template <class N>
  friend HEXAPLAST_INLINE N operator*(One, N a) {
    return a;
  }
};

/// factor times what acts on the mean columns and on the hourglass modes, at the corners.
template <class N, class Factor>
HEXAPLAST_INLINE void corners_of_modes(const Mat<N>& mean, const N (*Q)[3], Factor factor, CornerLanes<N>& f) {
  const N quarter = factor * N(ScalarOf<N>(0.25));
  ModeLanes<N> at;
  for (int n = 0; n < 3; ++n)
    for (int i = 0; i < 3; ++i) at.at[n][i] = quarter * mean(n, i);
  for (int l = 0; l < 4; ++l)
    for (int i = 0; i < 3; ++i) at.at[3 + l][i] = quarter * Q[l][i];
  modes_transpose(at, f);
}

/// The transpose: collects what acts on the columns of the samples and brings it to the corners.
template <bool kGeneral, class N>
struct ColumnsTranspose {
  using Rest = RestLanes<kGeneral, N>;

  HEXAPLAST_INLINE ColumnsTranspose() {
    if constexpr (kGeneral) {
      set_zero(e);
      set_zero(H);
      for (Mat<N>& M : turned) set_zero(M);
    }
  }

  /// Rows: what acts on the columns of a sample.
  HEXAPLAST_INLINE void add_columns(int sample, const Mat<N>& acting) {
    if constexpr (kGeneral)
      add_to_columns(sample, acting);
    else
      for (int k = 0; k < 9; ++k) by_modes[sample].m[k / 3][k % 3] = acting.m[k / 3][k % 3];
  }
  /// The same again of a sample that is in already.
  HEXAPLAST_INLINE void add_to_columns(int sample, const Mat<N>& acting) {
    for (int d = 0; d < 3; ++d) {
      N* to;
      if constexpr (!kGeneral)
        to = by_modes[sample].m[d];
      else
        to = e.at[d][kEdgeAt[sample][d]];
      for (int i = 0; i < 3; ++i) to[i] += acting(d, i);
    }
  }
  /// P on the whole gradient of a sample, where the inverses are those of corners.
  HEXAPLAST_INLINE void add_shared(int sample, const Mat<N>& P) {
    for (int k = 0; k < 9; ++k) H.m[k / 3][k % 3] += P.m[k / 3][k % 3];
    for (int n = 0; n < 3; ++n)
      for (int k = 0; k < 9; ++k)
        turned[n].m[k / 3][k % 3] = signed_sum(sample, n, turned[n].m[k / 3][k % 3], P.m[k / 3][k % 3]);
  }

  /// What acts on the modes by way of what is assumed. To be called once, when all samples are in.
  HEXAPLAST_INLINE void take_assumed(const Rest& rest, const AssumedLanes<N>& assumed) {
    if constexpr (kGeneral)
      for (int n = 0; n < 3; ++n)
        for (int i = 0; i < 3; ++i) a[n][i] = dot(turned[n].m[i], rest.dual.m[n]);
    else
      modes_of_columns(by_modes, rest.corner_weight, a, mean.m, on_modes);
    for (auto& mode : Q)
      for (N& entry : mode) entry = N(ScalarOf<N>(0));
    assumed.add_transpose(a, Q);
  }

  /// factor times all that, at the corners; mean_acting: rows, what acts on F_m 2 J_o besides, or null.
  template <class Factor>
  HEXAPLAST_INLINE void finish(const Rest& rest, const Mat<N>* mean_acting, Factor factor, CornerLanes<N>& f) {
    if constexpr (!kGeneral) {
      if (mean_acting)
        for (int k = 0; k < 9; ++k) mean.m[k / 3][k % 3] += mean_acting->m[k / 3][k % 3];
      for (int l = 0; l < 4; ++l)
        for (int i = 0; i < 3; ++i) on_modes[l][i] += Q[l][i];
      return corners_of_modes(mean, on_modes, factor, f);
    } else {
      for (int c = 0; c < kCorners; ++c)
        for (int r = 0; r < 3; ++r)
          f.at[c][r] = factor * (H(r, 0) * rest.h.at[c][0] + H(r, 1) * rest.h.at[c][1] + H(r, 2) * rest.h.at[c][2]);
      scale(factor * rest.corner_weight, e);
      if (mean_acting)
        mean = *mean_acting;
      else
        set_zero(mean);
      for (int l = 0; l < 3; ++l)
        for (int n = 0; n < 3; ++n)
          for (int i = 0; i < 3; ++i) mean(n, i) -= rest.skew[l][n] * Q[l][i];
      for (int c = 0; c < kCorners; ++c)
        for (int i = 0; i < 3; ++i)
          f.at[c][i] += factor * (rest.mean.at[c][0] * mean(0, i) + rest.mean.at[c][1] * mean(1, i) +
                                  rest.mean.at[c][2] * mean(2, i));
      for (auto& mode : Q)
        for (N& entry : mode) entry = factor * entry;
      add_hourglass_transpose(Q, e);
      add_edges_transpose(e, f);
    }
  }

  EdgeLanes<N> e;                            ///< unless by modes
  Mat<N> by_modes[kGeneral ? 1 : kCorners];  ///< rows, by sample
  Mat<N> H, turned[3];
  Mat<N> mean;       ///< by modes: what acts on it
  N on_modes[4][3];  ///< by modes: what acts on them by themselves
  N a[3][3];
  N Q[kGeneral ? 3 : 4][3];  ///< what acts on the modes by way of what is assumed
};

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
