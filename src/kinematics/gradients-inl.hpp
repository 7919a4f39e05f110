// SPDX-License-Identifier: LGPL-2.1-or-later
// Deformation gradients at the eight samples of a hexahedron, for elements in lanes and for one element, from the
// twelve edges.                                                                                       theory.md
// sections 2, 9.1
#if defined(HEXAPLAST_KINEMATICS_GRADIENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_KINEMATICS_GRADIENTS_INL
#undef HEXAPLAST_KINEMATICS_GRADIENTS_INL
#else
#define HEXAPLAST_KINEMATICS_GRADIENTS_INL
#endif

#include "kinematics/polar-inl.hpp"
#include "kinematics/sampling.hpp"
#include "layout/corners-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Edges of direction d run from corner kEdgeFrom[d][m] to kEdgeTo[d][m]; edge kEdgeAt[a][d] is the one at corner a.
/// Edges m and m ^ 1, and m and m ^ 2, share a face: they differ in the sign of the first, or second, other direction.
inline constexpr int kEdgeFrom[3][4] = {{0, 3, 4, 7}, {0, 1, 4, 5}, {0, 1, 3, 2}};
inline constexpr int kEdgeTo[3][4] = {{1, 2, 5, 6}, {3, 2, 7, 6}, {4, 5, 7, 6}};
inline constexpr int kEdgeAt[kCorners][3] = {{0, 0, 0}, {0, 1, 1}, {1, 1, 3}, {1, 0, 2},
                                             {2, 2, 0}, {2, 3, 1}, {3, 3, 3}, {3, 2, 2}};

/// Edge vectors, whole (not half): [direction][edge][component].
template <class N>
struct EdgeLanes {
  N at[3][4][3];
};

template <class N>
HWY_INLINE void set_zero(EdgeLanes<N>& e) {
  for (auto& direction : e.at)
    for (auto& edge : direction)
      for (N& entry : edge) entry = N(ScalarOf<N>(0));
}
template <class N>
HWY_INLINE void set_zero(Mat<N>& M) {
  for (int k = 0; k < 9; ++k) M.m[k / 3][k % 3] = N(ScalarOf<N>(0));
}
template <class N>
HWY_INLINE void scale(N factor, EdgeLanes<N>& e) {
  for (auto& direction : e.at)
    for (auto& edge : direction)
      for (N& entry : edge) entry *= factor;
}

template <class N>
HWY_INLINE void edges(const CornerLanes<N>& x, EdgeLanes<N>& e) {
  unrolled<12>([&](auto k) __attribute__((always_inline)) {
    constexpr int d = k / 4, m = k % 4;
    for (int i = 0; i < 3; ++i) e.at[d][m][i] = x.at[kEdgeTo[d][m]][i] - x.at[kEdgeFrom[d][m]][i];
  });
}

/// Transpose of edges(): what acts on an edge acts on its ends.
template <class N>
HWY_INLINE void add_edges_transpose(const EdgeLanes<N>& e, CornerLanes<N>& f) {
  unrolled<12>([&](auto k) __attribute__((always_inline)) {
    constexpr int d = k / 4, m = k % 4;
    for (int i = 0; i < 3; ++i) {
      f.at[kEdgeTo[d][m]][i] += e.at[d][m][i];
      f.at[kEdgeFrom[d][m]][i] -= e.at[d][m][i];
    }
  });
}

/// share e + (1 - share) mean of the four edges of the same direction. It is its own transpose.
template <class N>
HWY_INLINE void blend(N share, EdgeLanes<N>& e) {
  const N quarter = (N(ScalarOf<N>(1)) - share) * N(ScalarOf<N>(0.25));
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) {
      const N mean = quarter * ((e.at[d][0][i] + e.at[d][1][i]) + (e.at[d][2][i] + e.at[d][3][i]));
      for (int m = 0; m < 4; ++m) e.at[d][m][i] = share * e.at[d][m][i] + mean;
    }
}

/// Rows: the edges at a corner, as the columns of twice the Jacobian would be.
template <class N>
HWY_INLINE Mat<N> edges_at(const EdgeLanes<N>& e, int corner) {
  Mat<N> M;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) M(d, i) = e.at[d][kEdgeAt[corner][d]][i];
  return M;
}
/// Rows: the means of the edges of each direction.
template <class N>
HWY_INLINE Mat<N> mean_edges(const EdgeLanes<N>& e) {
  Mat<N> M;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i)
      M(d, i) = N(ScalarOf<N>(0.25)) * ((e.at[d][0][i] + e.at[d][1][i]) + (e.at[d][2][i] + e.at[d][3][i]));
  return M;
}

/// dV/dx of an element with these edges, over V where kPerVolume, and its volume V, exactly.                eq. 4, 9
///
/// dN_a/ds_d is bilinear in the two other coordinates: four moments of each column of cof(J) over the Gauss points hold
/// the integrals for all eight corners.
template <bool kPerVolume, class N>
HWY_INLINE void volume_gradient(const EdgeLanes<N>& e, CornerLanes<N>& gradient, N& volume) {
  using T = ScalarOf<N>;
  constexpr T kAt = T(0.57735026918962576451);  // Gauss point
  constexpr T kNear = (1 + kAt) / 2, kFar = (1 - kAt) / 2;

  // columns of 2 J at the four Gauss lines of each direction, [d][line]: lines ordered like the edges
  EdgeLanes<N> at;
  for (int d = 0; d < 3; ++d) {
    for (int i = 0; i < 3; ++i) {
      N half[4];
      for (int m = 0; m < 4; ++m) half[m] = N(kNear) * e.at[d][m][i] + N(kFar) * e.at[d][m ^ 1][i];
      for (int m = 0; m < 4; ++m) at.at[d][m][i] = N(kNear) * half[m] + N(kFar) * half[m ^ 2];
    }
  }

  EdgeLanes<N> moment;  // of cof(2 J)_d: sums over the points near the four edges of direction d
  set_zero(moment);
  N det_sum(T(0));
  unrolled<kCorners>([&](auto a) __attribute__((always_inline)) {
    const Mat<N> J = edges_at(at, a), cof = cofactor(J);
    det_sum += J(0, 0) * cof(0, 0) + J(0, 1) * cof(0, 1) + J(0, 2) * cof(0, 2);
    for (int d = 0; d < 3; ++d)
      for (int i = 0; i < 3; ++i) moment.at[d][kEdgeAt[a][d]][i] += cof(d, i);
  });
  volume = N(T(0.125)) * det_sum;

  // dN_a/ds_d at a Gauss line is sign / 2 times the weight of a's edge there: the same interpolation, transposed
  N scale(T(0.125));  // 1/2 of dN, 1/4 of cof(2 J) = 4 cof(J)
  if constexpr (kPerVolume) scale = scale / volume;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) {
      N half[4];
      for (int m = 0; m < 4; ++m) half[m] = N(kNear) * moment.at[d][m][i] + N(kFar) * moment.at[d][m ^ 1][i];
      for (int m = 0; m < 4; ++m) at.at[d][m][i] = scale * (N(kNear) * half[m] + N(kFar) * half[m ^ 2]);
    }
  set_zero(gradient);
  add_edges_transpose(at, gradient);
}

/// sum_a x_a (x) h_a.
template <class N>
HWY_INLINE Mat<N> outer_sum(const CornerLanes<N>& x, const CornerLanes<N>& h) {
  Mat<N> H;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      H(i, j) = x.at[0][i] * h.at[0][j];
      for (int a = 1; a < kCorners; ++a) H(i, j) += x.at[a][i] * h.at[a][j];
    }
  return H;
}

// Hourglass modes: how the edges differ. Of nodal values u, with the coordinates s of the reference cube,
//
//   Q_l = sum_a h_la u_a / 4,  h_0 = s_1 s_2, h_1 = s_0 s_2, h_2 = s_0 s_1, h_3 = s_0 s_1 s_2
//
// so that edge m of direction d is the mean of its four plus s_k Q_l + s_j Q_k + s_j s_k Q_3, j and k the other two
// directions, l the third one: k for j, j for k.

/// The other two directions, in the order in which the number of an edge counts them.
inline constexpr int kOther[3][2] = {{1, 2}, {0, 2}, {0, 1}};
/// Sign of the coordinate `which` of the other two at edge m.
constexpr int edge_sign(int m, int which) { return (m >> which & 1) != 0 ? 1 : -1; }

template <int kModes, class N>
HWY_INLINE void hourglass_modes(const EdgeLanes<N>& e, N (&Q)[kModes][3]) {
  const N quarter(ScalarOf<N>(0.25));
  for (int i = 0; i < 3; ++i) {
    Q[0][i] = quarter * ((e.at[1][2][i] + e.at[1][3][i]) - (e.at[1][0][i] + e.at[1][1][i]));
    Q[1][i] = quarter * ((e.at[0][2][i] + e.at[0][3][i]) - (e.at[0][0][i] + e.at[0][1][i]));
    Q[2][i] = quarter * ((e.at[0][1][i] + e.at[0][3][i]) - (e.at[0][0][i] + e.at[0][2][i]));
    if constexpr (kModes == 4) Q[3][i] = quarter * ((e.at[0][0][i] + e.at[0][3][i]) - (e.at[0][1][i] + e.at[0][2][i]));
  }
}
template <int kModes, class N>
HWY_INLINE void add_hourglass_transpose(const N (&Q)[kModes][3], EdgeLanes<N>& e) {
  const N quarter(ScalarOf<N>(0.25));
  for (int i = 0; i < 3; ++i) {
    const N first = quarter * Q[0][i], second = quarter * Q[1][i], third = quarter * Q[2][i];
    for (int m = 0; m < 4; ++m) {
      N &of_1 = e.at[1][m][i], &of_0 = e.at[0][m][i];
      of_1 = edge_sign(m, 1) > 0 ? of_1 + first : of_1 - first;
      of_0 = edge_sign(m, 1) > 0 ? of_0 + second : of_0 - second;
      of_0 = edge_sign(m, 0) > 0 ? of_0 + third : of_0 - third;
      if constexpr (kModes == 4) {
        const N fourth = quarter * Q[3][i];
        of_0 = edge_sign(m, 0) * edge_sign(m, 1) > 0 ? of_0 + fourth : of_0 - fourth;
      }
    }
  }
}

/// Constants of the material shape, for whole edges instead of half ones. Parallelepipeds, and samples that are made of
/// hourglass modes, need one inverse.
template <bool kGeneral, Assumed kAssumed, class N>
struct RestLanes {
  static constexpr bool kAtCorners = kGeneral && kAssumed != Assumed::kModes;
  static constexpr bool kHasMean = kGeneral && kAssumed != Assumed::kNothing;
  static constexpr int kModes = kAssumed == Assumed::kModes ? 4 : 3;

  Mat<N> inverse[kAtCorners ? kCorners : 1];  ///< J_i^-1 / 2; its rows belong to the edges of the corner
  CornerLanes<N> h;                           ///< where kAtCorners: what all samples share
  Mat<N> dual;                                ///< where kHasMean: J_o^-1 / 2
  CornerLanes<N> mean;                        ///< where kHasMean: Gm_a 2 J_o, so that F_m 2 J_o = sum_a x_a (x) mean_a
  N skew[kModes][3];  ///< where kHasMean: hourglass modes of the material shape, in its mean edges
  N volume;
  N least_jacobian;  ///< smallest det J_i
  N share;           ///< of the corner: Sampling::share
};

template <bool kGeneral, Assumed kAssumed, class N>
HWY_INLINE void rest_operator(const CornerLanes<N>& x, const Sampling& sampling,
                              RestLanes<kGeneral, kAssumed, N>& rest) {
  using T = ScalarOf<N>;
  using Rest = RestLanes<kGeneral, kAssumed, N>;
  rest.share = N(T(sampling.share));
  EdgeLanes<N> e;
  N det;
  edges(x, e);
  if constexpr (!kGeneral) {
    blend(N(T(0)), e);  // the mean: exactly what all corners share
    rest.inverse[0] = reciprocal(edges_at(e, 0), rest.volume);
    rest.least_jacobian = N(T(0.125)) * rest.volume;
  } else {
    rest.least_jacobian = N(T(1e30));
    for (int i = 0; i < kCorners; ++i) {
      const Mat<N> inverse = reciprocal(edges_at(e, i), det);
      if constexpr (Rest::kAtCorners) rest.inverse[i] = inverse;
      rest.least_jacobian = min(rest.least_jacobian, N(T(0.125)) * det);
    }
    CornerLanes<N> Gm;
    volume_gradient<true>(e, Gm, rest.volume);

    const Mat<N> centre_edges = mean_edges(e), centre = reciprocal(centre_edges, det);
    if constexpr (Rest::kHasMean) {
      rest.dual = centre;
      for (int a = 0; a < kCorners; ++a)
        for (int n = 0; n < 3; ++n)
          rest.mean.at[a][n] =
              Gm.at[a][0] * centre_edges(n, 0) + Gm.at[a][1] * centre_edges(n, 1) + Gm.at[a][2] * centre_edges(n, 2);
      N Q[Rest::kModes][3];
      hourglass_modes(e, Q);
      for (int l = 0; l < Rest::kModes; ++l)
        for (int n = 0; n < 3; ++n)
          rest.skew[l][n] = Q[l][0] * centre(n, 0) + Q[l][1] * centre(n, 1) + Q[l][2] * centre(n, 2);
    }
    if constexpr (!Rest::kAtCorners) {
      rest.inverse[0] = centre;
    } else if (!sampling.of_the_centre) {  // h = Gm - share mean g                                          eq. 8
      if (sampling.share == 1) {           // corners alone
        set_zero(rest.h);
      } else {
        rest.h = Gm;
        EdgeLanes<N> mean;
        for (int d = 0; d < 3; ++d)
          for (int m = 0; m < 4; ++m)
            for (int j = 0; j < 3; ++j)
              mean.at[d][m][j] = N(T(-sampling.share / kCorners)) *
                                 (rest.inverse[kEdgeFrom[d][m]](d, j) + rest.inverse[kEdgeTo[d][m]](d, j));
        add_edges_transpose(mean, rest.h);
      }
    } else {
      set_zero(rest.h);
      EdgeLanes<N> mean;
      for (int d = 0; d < 3; ++d)
        for (int m = 0; m < 4; ++m)
          for (int j = 0; j < 3; ++j) mean.at[d][m][j] = N(T(0.25)) * centre(d, j);
      add_edges_transpose(mean, rest.h);
    }
  }
}

/// The assumed part of the samples: a_n, which is added to column n of 2 Jhat at s_n = 1 and taken away at s_n = -1, of
/// the hourglass modes Q; j: rows R_m J^n, of any length.                                                      eq. E10
///
///   a_n = -share sum_(m, l) [ al_nm Q_l + be_nl (j_m - al_nm j_n) ],  al_nm = j_n . j_m / j_n . j_n,
///                                                                     be_nl = Q_l . j_n / j_n . j_n
///
/// over the two (m, l) with n, m, l different.
template <class N>
struct AssumedLanes {
  HWY_INLINE AssumedLanes(const Mat<N>& rows, N share) : j(rows), share_(share) {
    for (int n = 0; n < 3; ++n) {
      const N squared = j(n, 0) * j(n, 0) + j(n, 1) * j(n, 1) + j(n, 2) * j(n, 2);
      inverse_[n] = N(ScalarOf<N>(1)) / squared;
    }
    for (int n = 0; n < 3; ++n) {
      const int m = (n + 1) % 3;
      const N product = j(n, 0) * j(m, 0) + j(n, 1) * j(m, 1) + j(n, 2) * j(m, 2);
      al_[n][m] = product * inverse_[n];
      al_[m][n] = product * inverse_[m];
    }
  }

  template <int kModes>
  HWY_INLINE void columns(const N (&Q)[kModes][3], N (&a)[3][3]) const {
    for (int n = 0; n < 3; ++n) {
      N sum[3];
      for (int k = 1; k < 3; ++k) {
        const int m = (n + k) % 3, l = 3 - n - m;
        const N al = al_[n][m];
        const N be = (Q[l][0] * j(n, 0) + Q[l][1] * j(n, 1) + Q[l][2] * j(n, 2)) * inverse_[n];
        const N albe = al * be;
        for (int i = 0; i < 3; ++i) {
          const N part = al * Q[l][i] + be * j(m, i) - albe * j(n, i);
          sum[i] = k == 1 ? part : sum[i] + part;
        }
      }
      for (int i = 0; i < 3; ++i) a[n][i] = -(share_ * sum[i]);
    }
  }

  /// Q += the transpose of that, of what acts on the a_n.
  template <int kModes>
  HWY_INLINE void add_transpose(const N (&a)[3][3], N (&Q)[kModes][3]) const {
    for (int n = 0; n < 3; ++n) {
      N acting[3];
      for (int i = 0; i < 3; ++i) acting[i] = share_ * a[n][i];
      const N along = acting[0] * j(n, 0) + acting[1] * j(n, 1) + acting[2] * j(n, 2);
      for (int k = 1; k < 3; ++k) {
        const int m = (n + k) % 3, l = 3 - n - m;
        const N al = al_[n][m];
        const N across = (acting[0] * j(m, 0) + acting[1] * j(m, 1) + acting[2] * j(m, 2) - al * along) * inverse_[n];
        for (int i = 0; i < 3; ++i) Q[l][i] -= al * acting[i] + across * j(n, i);
      }
    }
  }

  Mat<N> j;

 private:
  N share_, inverse_[3], al_[3][3];
};

/// Columns of 2 Jhat at the samples, as far as they are linear in nodal values once the rotation of the mean is held.
template <bool kGeneral, Assumed kAssumed, class N>
struct ColumnLanes {
  using Rest = RestLanes<kGeneral, kAssumed, N>;

  EdgeLanes<N> e;        ///< by edges
  N a[3][3];             ///< assumed: of sign s_n in column n
  Mat<N> H;              ///< where the inverses are those of corners: what all gradients share
  Mat<N> turned[3];      ///< there: a_n (x) dual_n
  Mat<N> mean;           ///< rows: F_m 2 J_o
  N Q[Rest::kModes][3];  ///< hourglass modes
};

/// Mean columns and hourglass modes, which what is assumed needs.
template <bool kGeneral, Assumed kAssumed, class N>
HWY_INLINE void begin_columns(const RestLanes<kGeneral, kAssumed, N>& rest, const CornerLanes<N>& u,
                              ColumnLanes<kGeneral, kAssumed, N>& at) {
  edges(u, at.e);
  if constexpr (kAssumed != Assumed::kNothing) {
    hourglass_modes(at.e, at.Q);
    if constexpr (kGeneral) {
      for (int n = 0; n < 3; ++n)
        for (int i = 0; i < 3; ++i) {
          N sum = u.at[0][i] * rest.mean.at[0][n];
          for (int a = 1; a < kCorners; ++a) sum += u.at[a][i] * rest.mean.at[a][n];
          at.mean(n, i) = sum;
        }
      for (auto l = 0; l < ColumnLanes<kGeneral, kAssumed, N>::Rest::kModes; ++l)
        for (int i = 0; i < 3; ++i)
          at.Q[l][i] -=
              rest.skew[l][0] * at.mean(0, i) + rest.skew[l][1] * at.mean(1, i) + rest.skew[l][2] * at.mean(2, i);
    } else {
      at.mean = mean_edges(at.e);
    }
  }
}

/// Share of the mode s_0 s_1 s_2 in samples that are made of hourglass modes.
inline constexpr double kFourthShare = 1.0 / 3.0;

/// `how`: what is assumed; not used where nothing is.
template <bool kGeneral, Assumed kAssumed, class N, class How>
HWY_INLINE void finish_columns(const RestLanes<kGeneral, kAssumed, N>& rest, const CornerLanes<N>& u, const How& how,
                               ColumnLanes<kGeneral, kAssumed, N>& at) {
  using T = ScalarOf<N>;
  if constexpr (kAssumed != Assumed::kNothing) how.columns(at.Q, at.a);
  if constexpr (RestLanes<kGeneral, kAssumed, N>::kAtCorners) {
    at.H = outer_sum(u, rest.h);
    scale(rest.share, at.e);
    if constexpr (kAssumed != Assumed::kNothing)
      for (int n = 0; n < 3; ++n)
        for (int i = 0; i < 3; ++i)
          for (int k = 0; k < 3; ++k) at.turned[n](i, k) = at.a[n][i] * rest.dual(n, k);
  } else if constexpr (kGeneral) {
    for (int d = 0; d < 3; ++d) {
      const int j = kOther[d][0], k = kOther[d][1];
      for (int i = 0; i < 3; ++i) {
        const N by_j = rest.share * at.Q[k][i], by_k = rest.share * at.Q[j][i], both = N(T(kFourthShare)) * at.Q[3][i];
        const N near = at.mean(d, i) - by_k, far = at.mean(d, i) + by_k;
        at.e.at[d][0][i] = near - by_j + both;
        at.e.at[d][1][i] = near + by_j - both;
        at.e.at[d][2][i] = far - by_j - both;
        at.e.at[d][3][i] = far + by_j + both;
      }
    }
  } else {
    blend(rest.share, at.e);
    if constexpr (kAssumed == Assumed::kModes) {
      const N rest_of_share = N(T(kFourthShare)) - rest.share;
      for (int d = 0; d < 3; ++d)
        for (int i = 0; i < 3; ++i) {
          const N both = rest_of_share * at.Q[3][i];
          at.e.at[d][0][i] += both;
          at.e.at[d][1][i] -= both;
          at.e.at[d][2][i] -= both;
          at.e.at[d][3][i] += both;
        }
    }
  }
}

// A sample is an int or, in an unrolled loop, a constant.

/// a + s b with s coordinate d of a corner in the reference cube, 1 or -1.
template <class Corner, class N>
HWY_INLINE N signed_sum(Corner corner, int d, N a, N b) {
  if constexpr (std::is_same_v<Corner, int>)
    return a + N(static_cast<ScalarOf<N>>(kCornerSign[corner][d])) * b;
  else
    return kCornerSign[corner][d] > 0 ? a + b : a - b;
}

/// Rows: the columns at a sample, to be multiplied by its inverse.
template <bool kGeneral, Assumed kAssumed, class N, class Sample>
HWY_INLINE Mat<N> columns_at(const ColumnLanes<kGeneral, kAssumed, N>& at, Sample sample) {
  Mat<N> M = edges_at(at.e, sample);
  if constexpr (kAssumed != Assumed::kNothing && !RestLanes<kGeneral, kAssumed, N>::kAtCorners)
    for (int n = 0; n < 3; ++n)
      for (int i = 0; i < 3; ++i) M(n, i) = signed_sum(sample, n, M(n, i), at.a[n][i]);
  return M;
}
/// What is added to the gradient of a sample, where the inverses are those of corners.
template <bool kGeneral, Assumed kAssumed, class N, class Sample>
HWY_INLINE Mat<N> shared_at(const ColumnLanes<kGeneral, kAssumed, N>& at, Sample sample) {
  Mat<N> H = at.H;
  if constexpr (kAssumed != Assumed::kNothing)
    for (int n = 0; n < 3; ++n)
      for (int k = 0; k < 9; ++k)
        H.m[k / 3][k % 3] = signed_sum(sample, n, H.m[k / 3][k % 3], at.turned[n].m[k / 3][k % 3]);
  return H;
}

/// A factor of one that takes no multiplication.
struct One {
  template <class N>
  friend HWY_INLINE N operator*(One, N a) {
    return a;
  }
};

/// The transpose: collects what acts on the columns of the samples and brings it to the corners.
template <bool kGeneral, Assumed kAssumed, class N>
struct ColumnsTranspose {
  using Rest = RestLanes<kGeneral, kAssumed, N>;
  static constexpr bool kAssumes = kAssumed != Assumed::kNothing;

  HWY_INLINE ColumnsTranspose() {
    using T = ScalarOf<N>;
    set_zero(e);
    if constexpr (Rest::kAtCorners) {
      set_zero(H);
      if constexpr (kAssumes)
        for (Mat<N>& M : turned) set_zero(M);
    }
    if constexpr (kAssumes) {
      for (auto& column : a)
        for (N& entry : column) entry = N(T(0));
      for (auto& mode : Q)
        for (N& entry : mode) entry = N(T(0));
    }
  }

  /// Rows: what acts on the columns of a sample. Unrolled, samples come in their order.
  template <class Sample>
  HWY_INLINE void add_columns(Sample sample, const Mat<N>& acting) {
    for (int d = 0; d < 3; ++d) {
      N* const to = e.at[d][kEdgeAt[sample][d]];
      const bool is_first = !std::is_same_v<Sample, int> && sample < kEdgeNeighbour[sample][d];
      for (int i = 0; i < 3; ++i) to[i] = is_first ? acting(d, i) : to[i] + acting(d, i);
      if constexpr (kAssumes && !Rest::kAtCorners)
        for (int i = 0; i < 3; ++i) a[d][i] = signed_sum(sample, d, a[d][i], acting(d, i));
    }
  }
  /// P on the whole gradient of a sample, where the inverses are those of corners.
  template <class Sample>
  HWY_INLINE void add_shared(Sample sample, const Mat<N>& P) {
    for (int k = 0; k < 9; ++k) H.m[k / 3][k % 3] += P.m[k / 3][k % 3];
    if constexpr (kAssumes)
      for (int n = 0; n < 3; ++n)
        for (int k = 0; k < 9; ++k)
          turned[n].m[k / 3][k % 3] = signed_sum(sample, n, turned[n].m[k / 3][k % 3], P.m[k / 3][k % 3]);
  }

  /// What acts on the modes by way of what is assumed. To be called once, when all samples are in.
  template <class How>
  HWY_INLINE void take_assumed(const Rest& rest, const How& how) {
    if constexpr (kAssumes) {
      if constexpr (Rest::kAtCorners)
        for (int n = 0; n < 3; ++n)
          for (int i = 0; i < 3; ++i)
            a[n][i] = turned[n](i, 0) * rest.dual(n, 0) + turned[n](i, 1) * rest.dual(n, 1) +
                      turned[n](i, 2) * rest.dual(n, 2);
      how.add_transpose(a, Q);
    }
  }

  /// All that acts on the modes, where samples are made of them: by way of what is assumed, and by themselves.
  HWY_INLINE void all_on_modes(const Rest& rest, N (&total)[4][3]) const {
    using T = ScalarOf<N>;
    for (int l = 0; l < 4; ++l)
      for (int i = 0; i < 3; ++i) total[l][i] = Q[l][i];
    for (int d = 0; d < 3; ++d) {
      const int j = kOther[d][0], k = kOther[d][1];
      const auto& of = e.at[d];
      for (int i = 0; i < 3; ++i) {
        total[k][i] += rest.share * ((of[1][i] + of[3][i]) - (of[0][i] + of[2][i]));
        total[j][i] += rest.share * ((of[2][i] + of[3][i]) - (of[0][i] + of[1][i]));
        total[3][i] += N(T(kFourthShare)) * ((of[0][i] + of[3][i]) - (of[1][i] + of[2][i]));
      }
    }
  }

  /// factor times all that, at the corners; mean_acting: rows, what acts on F_m 2 J_o besides, or null.
  template <class Factor>
  HWY_INLINE void finish(const Rest& rest, const Mat<N>* mean_acting, Factor factor, CornerLanes<N>& f) {
    using T = ScalarOf<N>;
    if constexpr (Rest::kAtCorners) {
      for (int c = 0; c < kCorners; ++c)
        for (int r = 0; r < 3; ++r)
          f.at[c][r] = factor * (H(r, 0) * rest.h.at[c][0] + H(r, 1) * rest.h.at[c][1] + H(r, 2) * rest.h.at[c][2]);
      scale(factor * rest.share, e);
    } else {
      set_zero(f);
    }
    Mat<N> mean;
    if constexpr (kGeneral && kAssumes) {
      if (mean_acting)
        mean = *mean_acting;
      else
        set_zero(mean);
      if constexpr (!Rest::kAtCorners) {
        for (int d = 0; d < 3; ++d) {
          for (int i = 0; i < 3; ++i) mean(d, i) += (e.at[d][0][i] + e.at[d][1][i]) + (e.at[d][2][i] + e.at[d][3][i]);
        }
        all_on_modes(rest, Q);
        set_zero(e);
      }
      for (int l = 0; l < Rest::kModes; ++l)
        for (int n = 0; n < 3; ++n)
          for (int i = 0; i < 3; ++i) mean(n, i) -= rest.skew[l][n] * Q[l][i];
      for (int c = 0; c < kCorners; ++c)
        for (int i = 0; i < 3; ++i)
          f.at[c][i] += factor * (rest.mean.at[c][0] * mean(0, i) + rest.mean.at[c][1] * mean(1, i) +
                                  rest.mean.at[c][2] * mean(2, i));
    } else if constexpr (!kGeneral) {
      if constexpr (kAssumed == Assumed::kModes) {
        const N rest_of_share = N(T(kFourthShare)) - rest.share;
        for (int d = 0; d < 3; ++d)
          for (int i = 0; i < 3; ++i) {
            const auto& of = e.at[d];
            Q[3][i] += rest_of_share * ((of[0][i] + of[3][i]) - (of[1][i] + of[2][i]));
          }
      }
      blend(rest.share, e);
      if (kAssumes && mean_acting)
        for (int d = 0; d < 3; ++d)
          for (int i = 0; i < 3; ++i) {
            const N quarter = N(T(0.25)) * (*mean_acting)(d, i);
            for (int m = 0; m < 4; ++m) e.at[d][m][i] += quarter;
          }
      if constexpr (!std::is_same_v<Factor, One>) scale(factor, e);
    }
    if constexpr (kAssumes) {
      for (auto& mode : Q)
        for (N& entry : mode) entry = factor * entry;
      add_hourglass_transpose(Q, e);
    }
    add_edges_transpose(e, f);
  }

  EdgeLanes<N> e;
  Mat<N> H, turned[3];
  N a[3][3];
  N Q[Rest::kModes][3];
};

/// Deformation gradient at the centre.                                                                        eq. 1
template <class N>
HWY_INLINE Mat<N> centre_gradient(const CornerLanes<N>& x, const CornerLanes<N>& u) {
  EdgeLanes<N> world, material;
  N det;
  edges(u, world);
  edges(x, material);
  return transposed_product(mean_edges(world), reciprocal(mean_edges(material), det));
}

/// Corners of elements that are not there become those of the unit cube, so that everything computed of them is finite.
template <class V>
HWY_INLINE void replace_absent(std::uint32_t present, CornerLanes<V>& x) {
  using T = typename V::Scalar;
  constexpr std::uint32_t kAll = (1u << V::kCount) - 1;
  if (HWY_LIKELY((present & kAll) == kAll)) return;
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) x.at[a][i] = select_bits(present, x.at[a][i], V(T(kCornerSign[a][i] > 0 ? 1 : 0)));
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
