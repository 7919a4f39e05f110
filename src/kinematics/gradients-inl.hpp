// SPDX-License-Identifier: LGPL-2.1-or-later
// Deformation gradients of one element per SIMD lane, from the twelve edges of the hexahedron.  theory.md section 9.1
#if defined(HEXAPLAST_KINEMATICS_GRADIENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_KINEMATICS_GRADIENTS_INL
#undef HEXAPLAST_KINEMATICS_GRADIENTS_INL
#else
#define HEXAPLAST_KINEMATICS_GRADIENTS_INL
#endif

#include "hexaplast/material/material.hpp"
#include "kinematics/polar-inl.hpp"
#include "layout/corners-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Edges of direction d run from corner kEdgeFrom[d][m] to kEdgeTo[d][m]; edge kEdgeAt[a][d] is the one at corner a.
/// Edges m and m ^ 1, and m and m ^ 2, share a face.
inline constexpr int kEdgeFrom[3][4] = {{0, 3, 4, 7}, {0, 1, 4, 5}, {0, 1, 3, 2}};
inline constexpr int kEdgeTo[3][4] = {{1, 2, 5, 6}, {3, 2, 7, 6}, {4, 5, 7, 6}};
inline constexpr int kEdgeAt[kCorners][3] = {{0, 0, 0}, {0, 1, 1}, {1, 1, 3}, {1, 0, 2},
                                             {2, 2, 0}, {2, 3, 1}, {3, 3, 3}, {3, 2, 2}};

/// Edge vectors, whole (not half): [direction][edge][component].
template <class V>
struct EdgeLanes {
  V at[3][4][3];
};

template <class V>
HWY_INLINE void set_zero(EdgeLanes<V>& e) {
  for (auto& direction : e.at)
    for (auto& edge : direction)
      for (V& entry : edge) entry = V(typename V::Scalar(0));
}
template <class V>
HWY_INLINE void scale(V factor, EdgeLanes<V>& e) {
  for (auto& direction : e.at)
    for (auto& edge : direction)
      for (V& entry : edge) entry *= factor;
}

template <class V>
HWY_INLINE void edges(const CornerLanes<V>& x, EdgeLanes<V>& e) {
  unrolled<12>([&](auto k) __attribute__((always_inline)) {
    constexpr int d = k / 4, m = k % 4;
    for (int i = 0; i < 3; ++i) e.at[d][m][i] = x.at[kEdgeTo[d][m]][i] - x.at[kEdgeFrom[d][m]][i];
  });
}

/// Transpose of edges(): what acts on an edge acts on its ends.
template <class V>
HWY_INLINE void add_edges_transpose(const EdgeLanes<V>& e, CornerLanes<V>& f) {
  unrolled<12>([&](auto k) __attribute__((always_inline)) {
    constexpr int d = k / 4, m = k % 4;
    for (int i = 0; i < 3; ++i) {
      f.at[kEdgeTo[d][m]][i] += e.at[d][m][i];
      f.at[kEdgeFrom[d][m]][i] -= e.at[d][m][i];
    }
  });
}

/// share e + (1 - share) mean of the four edges of the same direction. It is its own transpose.
template <class V>
HWY_INLINE void blend(V share, EdgeLanes<V>& e) {
  const V quarter = (V(1) - share) * V(typename V::Scalar(0.25));
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) {
      const V mean = quarter * ((e.at[d][0][i] + e.at[d][1][i]) + (e.at[d][2][i] + e.at[d][3][i]));
      for (int m = 0; m < 4; ++m) e.at[d][m][i] = share * e.at[d][m][i] + mean;
    }
}

/// Rows: the edges at a corner, as the columns of twice the Jacobian would be.
template <class V>
HWY_INLINE Mat<V> edges_at(const EdgeLanes<V>& e, int corner) {
  Mat<V> M;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) M(d, i) = e.at[d][kEdgeAt[corner][d]][i];
  return M;
}

/// The exact mean of the shape gradients, and the volume.                                       theory.md eq. 9
///
/// dN_a/ds_d is bilinear in the two other coordinates: four moments of each column of cof(J) over the Gauss points hold
/// the means for all eight corners.
template <class V>
HWY_INLINE void mean_gradients(const EdgeLanes<V>& e, CornerLanes<V>& mean, V& volume) {
  using T = typename V::Scalar;
  constexpr T kAt = T(0.57735026918962576451);  // Gauss point
  constexpr T kNear = (1 + kAt) / 2, kFar = (1 - kAt) / 2;

  // columns of 2 J at the four Gauss lines of each direction, [d][line]: lines ordered like the edges
  EdgeLanes<V> at;
  for (int d = 0; d < 3; ++d) {
    for (int i = 0; i < 3; ++i) {
      V half[4];
      for (int m = 0; m < 4; ++m) half[m] = V(kNear) * e.at[d][m][i] + V(kFar) * e.at[d][m ^ 1][i];
      for (int m = 0; m < 4; ++m) at.at[d][m][i] = V(kNear) * half[m] + V(kFar) * half[m ^ 2];
    }
  }

  EdgeLanes<V> moment;  // of cof(2 J)_d: sums over the points near the four edges of direction d
  set_zero(moment);
  V det_sum(T(0));
  unrolled<kCorners>([&](auto a) __attribute__((always_inline)) {
    const Mat<V> J = edges_at(at, a), cof = cofactor(J);
    det_sum += J(0, 0) * cof(0, 0) + J(0, 1) * cof(0, 1) + J(0, 2) * cof(0, 2);
    for (int d = 0; d < 3; ++d)
      for (int i = 0; i < 3; ++i) moment.at[d][kEdgeAt[a][d]][i] += cof(d, i);
  });
  volume = V(T(0.125)) * det_sum;

  // dN_a/ds_d at a Gauss line is sign / 2 times the weight of a's edge there: the same interpolation, transposed
  const V scale = V(T(0.125)) / volume;  // 1/2 of dN, 1/4 of cof(2 J) = 4 cof(J)
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < 3; ++i) {
      V half[4];
      for (int m = 0; m < 4; ++m) half[m] = V(kNear) * moment.at[d][m][i] + V(kFar) * moment.at[d][m ^ 1][i];
      for (int m = 0; m < 4; ++m) at.at[d][m][i] = scale * (V(kNear) * half[m] + V(kFar) * half[m ^ 2]);
    }
  set_zero(mean);
  add_edges_transpose(at, mean);
}

/// sum_a x_a (x) h_a.
template <class V>
HWY_INLINE Mat<V> outer_sum(const CornerLanes<V>& x, const CornerLanes<V>& h) {
  Mat<V> H;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      H(i, j) = x.at[0][i] * h.at[0][j];
      for (int a = 1; a < kCorners; ++a) H(i, j) += x.at[a][i] * h.at[a][j];
    }
  return H;
}

/// RestOperator of one element per lane, for whole edges instead of half ones. Parallelepipeds need one inverse.
template <bool kGeneral, class V>
struct RestLanes {
  Mat<V> inverse[kGeneral ? kCorners : 1];  ///< J_i^-1 / 2; its rows belong to the edges of the corner
  CornerLanes<V> h;                         ///< of general shapes
  V volume;
  V least_jacobian;  ///< smallest det J_i
  V share;           ///< RestOperator::corner_weight
};

template <bool kGeneral, class V>
HWY_INLINE void rest_operator(const CornerLanes<V>& x, GradientScheme scheme, RestLanes<kGeneral, V>& rest) {
  using T = typename V::Scalar;
  rest.share = V(T(scheme == GradientScheme::kBlended ? 0.5 : scheme == GradientScheme::kVertex ? 1.0 : 0.0));
  EdgeLanes<V> e;
  V det;
  edges(x, e);
  if constexpr (!kGeneral) {
    blend(V(T(0)), e);  // the mean: exactly what all corners share
    rest.inverse[0] = reciprocal(edges_at(e, 0), rest.volume);
    rest.least_jacobian = V(T(0.125)) * rest.volume;
  } else {
    rest.least_jacobian = V(T(1e30));
    for (int i = 0; i < kCorners; ++i) {
      rest.inverse[i] = reciprocal(edges_at(e, i), det);
      rest.least_jacobian = min(rest.least_jacobian, V(T(0.125)) * det);
    }
    mean_gradients(e, rest.h, rest.volume);
    if (scheme == GradientScheme::kBlended) {  // h = Gm - mean g / 2                                        eq. 8
      EdgeLanes<V> mean;
      for (int d = 0; d < 3; ++d)
        for (int m = 0; m < 4; ++m)
          for (int j = 0; j < 3; ++j)
            mean.at[d][m][j] =
                V(T(-0.5 / kCorners)) * (rest.inverse[kEdgeFrom[d][m]](d, j) + rest.inverse[kEdgeTo[d][m]](d, j));
      add_edges_transpose(mean, rest.h);
    } else {
      set_zero(rest.h);
      if (scheme == GradientScheme::kCentre) {
        EdgeLanes<V> mean = e;
        blend(V(T(0)), mean);
        const Mat<V> centre = reciprocal(edges_at(mean, 0), det);
        for (int d = 0; d < 3; ++d)
          for (int m = 0; m < 4; ++m)
            for (int j = 0; j < 3; ++j) mean.at[d][m][j] = V(T(0.25)) * centre(d, j);
        add_edges_transpose(mean, rest.h);
      }
    }
  }
}

/// Deformation gradients of one element per lane at world positions u, sample by sample.                    eq. 7
template <bool kGeneral, class V>
class GradientLanes {
 public:
  HWY_INLINE GradientLanes(const RestLanes<kGeneral, V>& rest, const CornerLanes<V>& u) : rest_(rest) {
    edges(u, e_);
    if constexpr (kGeneral) {
      shared_ = outer_sum(u, rest.h);
      scale(rest.share, e_);
    } else {
      blend(rest.share, e_);
    }
  }
  HWY_INLINE Mat<V> operator()(int sample) const {
    Mat<V> F = transposed_product(edges_at(e_, sample), rest_.inverse[kGeneral ? sample : 0]);
    if constexpr (kGeneral)
      for (int k = 0; k < 9; ++k) F.m[k / 3][k % 3] += shared_.m[k / 3][k % 3];
    return F;
  }

 private:
  const RestLanes<kGeneral, V>& rest_;
  EdgeLanes<V> e_;
  Mat<V> shared_;
};

/// Deformation gradient at the centre.                                                                        eq. 1
template <class V>
HWY_INLINE Mat<V> centre_gradient(const CornerLanes<V>& x, const CornerLanes<V>& u) {
  using T = typename V::Scalar;
  EdgeLanes<V> world, material;
  V det;
  edges(u, world);
  edges(x, material);
  blend(V(T(0)), world);
  blend(V(T(0)), material);
  return transposed_product(edges_at(world, 0), reciprocal(edges_at(material, 0), det));
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
