// SPDX-License-Identifier: LGPL-2.1-or-later
// A hexahedron by its twelve edges, for elements in lanes and for one element: its volume, its hourglass modes and the
// constants of its plastic rest shape.                                                        theory.md sections 2, 9.1
#if defined(HEXAPLAST_KINEMATICS_GRADIENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_KINEMATICS_GRADIENTS_INL
#undef HEXAPLAST_KINEMATICS_GRADIENTS_INL
#else
#define HEXAPLAST_KINEMATICS_GRADIENTS_INL
#endif

#include "kinematics/polar-inl.hpp"
#include "kinematics/sampling.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Edges of direction d run from corner kEdgeFrom[d][m] to kEdgeTo[d][m]; edge kEdgeAt[a][d] is the one at corner a.
/// Edges m and m ^ 1, and m and m ^ 2, share a face: they differ in the sign of the first, or second, other direction.
HEXAPLAST_TABLE int kEdgeFrom[3][4] = {{0, 3, 4, 7}, {0, 1, 4, 5}, {0, 1, 3, 2}};
HEXAPLAST_TABLE int kEdgeTo[3][4] = {{1, 2, 5, 6}, {3, 2, 7, 6}, {4, 5, 7, 6}};
HEXAPLAST_TABLE int kEdgeAt[kCorners][3] = {{0, 0, 0}, {0, 1, 1}, {1, 1, 3}, {1, 0, 2},
                                            {2, 2, 0}, {2, 3, 1}, {3, 3, 3}, {3, 2, 2}};

/// Edge vectors, whole (not half): [direction][edge][component].
template <class N>
struct EdgeLanes {
  N at[3][4][3];
};

template <class N>
HEXAPLAST_INLINE void set_zero(EdgeLanes<N>& e) {
  for (auto& direction : e.at)
    for (auto& edge : direction)
      for (N& entry : edge) entry = N(ScalarOf<N>(0));
}
template <class N>
HEXAPLAST_INLINE void set_zero(Mat<N>& M) {
  for (int k = 0; k < 9; ++k) M.m[k / 3][k % 3] = N(ScalarOf<N>(0));
}
template <class N>
HEXAPLAST_INLINE void scale(N factor, EdgeLanes<N>& e) {
  for (auto& direction : e.at)
    for (auto& edge : direction)
      for (N& entry : edge) entry *= factor;
}

template <class N>
HEXAPLAST_INLINE void edges(const CornerLanes<N>& x, EdgeLanes<N>& e) {
  unrolled<12>([&](auto k) __attribute__((always_inline)) {
    constexpr int d = k / 4, m = k % 4;
    for (int i = 0; i < 3; ++i) e.at[d][m][i] = x.at[kEdgeTo[d][m]][i] - x.at[kEdgeFrom[d][m]][i];
  });
}

/// Transpose of edges(): what acts on an edge acts on its ends.
template <class N>
HEXAPLAST_INLINE void add_edges_transpose(const EdgeLanes<N>& e, CornerLanes<N>& f) {
  unrolled<12>([&](auto k) __attribute__((always_inline)) {
    constexpr int d = k / 4, m = k % 4;
    for (int i = 0; i < 3; ++i) {
      f.at[kEdgeTo[d][m]][i] += e.at[d][m][i];
      f.at[kEdgeFrom[d][m]][i] -= e.at[d][m][i];
    }
  });
}

/// Rows: the edges at a corner, as the columns of twice the Jacobian would be.
template <class N>
HEXAPLAST_INLINE Mat<N> edges_at(const EdgeLanes<N>& e, int corner) {
  Mat<N> M;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) M(d, i) = e.at[d][kEdgeAt[corner][d]][i];
  return M;
}
/// Rows: the means of the edges of each direction.
template <class N>
HEXAPLAST_INLINE Mat<N> mean_edges(const EdgeLanes<N>& e) {
  Mat<N> M;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i)
      M(d, i) = N(ScalarOf<N>(0.25)) * ((e.at[d][0][i] + e.at[d][1][i]) + (e.at[d][2][i] + e.at[d][3][i]));
  return M;
}

/// dV/dx over V of an element with these edges, and its volume V, exactly.                                  eq. 4, 9
///
/// dN_a/ds_d is bilinear in the two other coordinates: four moments of each column of cof(J) over the Gauss points hold
/// the integrals for all eight corners.
template <class N>
HEXAPLAST_INLINE void volume_gradient(const EdgeLanes<N>& e, CornerLanes<N>& gradient, N& volume) {
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
  const N scale = N(T(0.125)) / volume;  // 1/2 of dN, 1/4 of cof(2 J) = 4 cof(J)
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
HEXAPLAST_INLINE Mat<N> outer_sum(const CornerLanes<N>& x, const CornerLanes<N>& h) {
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
HEXAPLAST_TABLE int kOther[3][2] = {{1, 2}, {0, 2}, {0, 1}};
/// Sign of the coordinate `which` of the other two at edge m.
constexpr int edge_sign(int m, int which) { return (m >> which & 1) != 0 ? 1 : -1; }

/// The first three.
template <class N>
HEXAPLAST_INLINE void hourglass_modes(const EdgeLanes<N>& e, N (&Q)[3][3]) {
  const N quarter(ScalarOf<N>(0.25));
  for (int i = 0; i < 3; ++i) {
    Q[0][i] = quarter * ((e.at[1][2][i] + e.at[1][3][i]) - (e.at[1][0][i] + e.at[1][1][i]));
    Q[1][i] = quarter * ((e.at[0][2][i] + e.at[0][3][i]) - (e.at[0][0][i] + e.at[0][1][i]));
    Q[2][i] = quarter * ((e.at[0][1][i] + e.at[0][3][i]) - (e.at[0][0][i] + e.at[0][2][i]));
  }
}
template <class N>
HEXAPLAST_INLINE void add_hourglass_transpose(const N (&Q)[3][3], EdgeLanes<N>& e) {
  const N quarter(ScalarOf<N>(0.25));
  for (int i = 0; i < 3; ++i) {
    const N first = quarter * Q[0][i], second = quarter * Q[1][i], third = quarter * Q[2][i];
    for (int m = 0; m < 4; ++m) {
      N &of_1 = e.at[1][m][i], &of_0 = e.at[0][m][i];
      of_1 = edge_sign(m, 1) > 0 ? of_1 + first : of_1 - first;
      of_0 = edge_sign(m, 1) > 0 ? of_0 + second : of_0 - second;
      of_0 = edge_sign(m, 0) > 0 ? of_0 + third : of_0 - third;
    }
  }
}

/// Constants of the plastic rest shape, for whole edges instead of half ones. Parallelepipeds, of elements alone, need
/// one inverse.
template <bool kGeneral, class N>
struct RestLanes {
  Mat<N> inverse[kGeneral ? kCorners : 1];  ///< J_i^-1 / 2; its rows belong to the edges of the corner
  CornerLanes<N> h;                         ///< where kGeneral: what all samples share
  Mat<N> dual;                              ///< where kGeneral: J_o^-1 / 2
  CornerLanes<N> mean;                      ///< where kGeneral: Gm_a 2 J_o, so that F_m 2 J_o = sum_a x_a (x) mean_a
  N skew[3][3];  ///< where kGeneral: hourglass modes of the plastic rest shape, in its mean edges
  N volume;
  N min_jacobian;   ///< smallest det J_i
  N corner_weight;  ///< of the corner: Sampling::corner_weight
};

template <bool kGeneral, class N>
HEXAPLAST_INLINE void rest_operator(const CornerLanes<N>& x, const Sampling& sampling, RestLanes<kGeneral, N>& rest) {
  using T = ScalarOf<N>;
  rest.corner_weight = N(T(sampling.corner_weight));
  EdgeLanes<N> e;
  N det;
  edges(x, e);
  if constexpr (!kGeneral) {
    assign(reciprocal(mean_edges(e), rest.volume), rest.inverse[0]);  // of what all corners share
    rest.min_jacobian = N(T(0.125)) * rest.volume;
  } else {
    rest.min_jacobian = N(T(1e30));
    for (int i = 0; i < kCorners; ++i) {
      rest.inverse[i] = reciprocal(edges_at(e, i), det);
      rest.min_jacobian = min(rest.min_jacobian, N(T(0.125)) * det);
    }
    CornerLanes<N> Gm;
    volume_gradient(e, Gm, rest.volume);
    const Mat<N> centre_edges = mean_edges(e), centre = reciprocal(centre_edges, det);
    rest.dual = centre;
    for (int a = 0; a < kCorners; ++a)
      for (int n = 0; n < 3; ++n)
        rest.mean.at[a][n] =
            Gm.at[a][0] * centre_edges(n, 0) + Gm.at[a][1] * centre_edges(n, 1) + Gm.at[a][2] * centre_edges(n, 2);
    N Q[3][3];
    hourglass_modes(e, Q);
    for (int l = 0; l < 3; ++l)
      for (int n = 0; n < 3; ++n)
        rest.skew[l][n] = Q[l][0] * centre(n, 0) + Q[l][1] * centre(n, 1) + Q[l][2] * centre(n, 2);
    rest.h = Gm;  // h = Gm - corner_weight mean g                                                              eq. 8
    EdgeLanes<N> mean;
    for (int d = 0; d < 3; ++d)
      for (int m = 0; m < 4; ++m)
        for (int j = 0; j < 3; ++j)
          mean.at[d][m][j] = N(T(-sampling.corner_weight / kCorners)) *
                             (rest.inverse[kEdgeFrom[d][m]](d, j) + rest.inverse[kEdgeTo[d][m]](d, j));
    add_edges_transpose(mean, rest.h);
  }
}

/// Deformation gradient at the centre.                                                                        eq. 1
template <class N>
HEXAPLAST_INLINE Mat<N> centre_gradient(const CornerLanes<N>& x, const CornerLanes<N>& u) {
  EdgeLanes<N> current, plastic_rest;
  N det;
  edges(u, current);
  edges(x, plastic_rest);
  return transposed_product(mean_edges(current), reciprocal(mean_edges(plastic_rest), det));
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
