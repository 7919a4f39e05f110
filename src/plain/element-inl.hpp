// SPDX-License-Identifier: LGPL-2.1-or-later
// The elastic element of the paper with all of its variants, to be read beside it. For elements in lanes and for one
// element.                                                                                      theory.md sections 2, 3
#if defined(HEXAPLAST_PLAIN_ELEMENT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_PLAIN_ELEMENT_INL
#undef HEXAPLAST_PLAIN_ELEMENT_INL
#else
#define HEXAPLAST_PLAIN_ELEMENT_INL
#endif

#include "base/tensors-inl.hpp"
#include "element/element-inl.hpp"
#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "kinematics/gradients-inl.hpp"
#include "material/law-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// A column of a matrix, and what it becomes.
template <class N>
struct Column {
  N at[3];
};
template <class N>
HEXAPLAST_INLINE Column<N> column(const Mat<N>& A, int n) {
  return {{A(0, n), A(1, n), A(2, n)}};
}
template <class N>
HEXAPLAST_INLINE Column<N> cross(const Column<N>& a, const Column<N>& b) {
  return {{a.at[1] * b.at[2] - a.at[2] * b.at[1], a.at[2] * b.at[0] - a.at[0] * b.at[2],
           a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}
template <class N>
HEXAPLAST_INLINE Column<N> operator*(const Mat<N>& A, const Column<N>& b) {
  return {{dot(A.m[0], b.at), dot(A.m[1], b.at), dot(A.m[2], b.at)}};
}
template <class N>
HEXAPLAST_INLINE Mat<N> transposed(const Mat<N>& A) {
  return {{{A(0, 0), A(1, 0), A(2, 0)}, {A(0, 1), A(1, 1), A(2, 1)}, {A(0, 2), A(1, 2), A(2, 2)}}};
}

/// f_a += P g_a.
template <class N>
HEXAPLAST_INLINE void add_products(const Mat<N>& P, const CornerLanes<N>& g, CornerLanes<N>& f) {
  for (int a = 0; a < kCorners; ++a)
    for (int k = 0; k < 3; ++k) f.at[a][k] += dot(P.m[k], g.at[a]);
}

/// factor g_a.
template <class N>
HEXAPLAST_INLINE CornerLanes<N> scaled(N factor, const CornerLanes<N>& g) {
  CornerLanes<N> out;
  for (int a = 0; a < kCorners; ++a)
    for (int k = 0; k < 3; ++k) out.at[a][k] = factor * g.at[a][k];
  return out;
}

/// How the gradients of the samples follow from the corners.                                                    eq. 7
///
///   F~_i = c F_i + sum_a x_a (x) h_a,   h_a = Gm_a - c mean_j g_ja                                            eq. 8
template <class N>
struct SampleGradients {
  Mat<N> inverse[kCorners];  ///< [1/m] rows d of c J_i^-1 / 2, which belong to the edges of corner i
  CornerLanes<N> shared;     ///< [1/m] h_a
  CornerLanes<N> mean;       ///< [1/m] Gm_a                                                                     eq. 9
  N volume;                  ///< [m^3]
  N jacobian[kCorners];      ///< [m^3] det J_i

  /// rest: edges of the rest shape.
  HEXAPLAST_NOINLINE void set(const EdgeLanes<N>& rest, const Sampling& sampling) {
    volume_gradient(rest, mean, volume);
    EdgeLanes<N> corners;  // -c times the mean of g_ja, by edges
    set_zero(corners);
    for (int i = 0; i < kCorners; ++i) {
      N det;
      inverse[i] = HWY_NAMESPACE::scaled(N(sampling.corner_weight), reciprocal(edges_at(rest, i), det));
      jacobian[i] = N(0.125) * det;
      add_at_edges(i, HWY_NAMESPACE::scaled(N(-1.0 / kCorners), inverse[i]), corners);
    }
    if (sampling.of_the_centre) {  // c = 0
      N det;
      const Mat<N> centre = HWY_NAMESPACE::scaled(N(0.25), reciprocal(mean_edges(rest), det));
      for (int d = 0; d < 3; ++d)
        for (auto& edge : corners.at[d])
          for (int k = 0; k < 3; ++k) edge[k] = centre(d, k);
    }
    if (sampling.of_the_centre || sampling.corner_weight == 1)
      set_zero(shared);
    else
      shared = mean;
    if (sampling.corner_weight != 1) add_edges_transpose(corners, shared);
  }

  /// Of nodal values u.
  HEXAPLAST_NOINLINE void gradients(const CornerLanes<N>& u, Mat<N> (&F)[kCorners]) const {
    EdgeLanes<N> e;
    edges(u, e);
    const Mat<N> H = outer_sum(u, shared);
    for (int i = 0; i < kCorners; ++i) F[i] = transposed_product(edges_at(e, i), inverse[i]) + H;
  }

  /// The transpose: what stresses P_i act with on u, per corner.
  HEXAPLAST_NOINLINE CornerLanes<N> transpose(const Mat<N> (&P)[kCorners]) const {
    EdgeLanes<N> e;
    set_zero(e);
    Mat<N> sum = P[0];
    for (int i = 0; i < kCorners; ++i) {
      add_at_edges(i, product_transposed(inverse[i], P[i]), e);
      if (i > 0) sum = sum + P[i];
    }
    CornerLanes<N> acting;
    set_zero(acting);
    add_products(sum, shared, acting);
    add_edges_transpose(e, acting);
    return acting;
  }

 private:
  static HEXAPLAST_INLINE void add_at_edges(int corner, const Mat<N>& rows, EdgeLanes<N>& e) {
    for (int d = 0; d < 3; ++d)
      for (int k = 0; k < 3; ++k) e.at[d][kEdgeAt[corner][d]][k] += rows(d, k);
  }
};

/// The strain of `assumedCorner`: its part linear in a coordinate n is tangential to the faces of that coordinate.
/// Linear in nodal values u while R is held fixed.                                                     theory.md 2.1
template <class N>
class AssumedStrain {
 public:
  /// rest: corners [m] and Gm of the rest shape; weight: c; plastic: Gm of isolated rest shapes.                eq. P2
  HEXAPLAST_NOINLINE void set(const CornerLanes<N>& rest, const CornerLanes<N>& mean_gradient,
                              const CornerLanes<N>& current, double weight, const Mat<N>& plastic) {
    weight_ = N(weight);
    EdgeLanes<N> e;
    N det;
    edges(rest, e);
    J_inverse_ = scaled(N(2.0), reciprocal(mean_edges(e), det));
    CornerLanes<N> h;  // eta zeta, xi zeta, xi eta
    for (int a = 0; a < kCorners; ++a)
      for (int l = 0; l < 3; ++l) h.at[a][l] = N(kCornerSign[a][(l + 1) % 3] * kCornerSign[a][(l + 2) % 3]);
    const Mat<N> moments = outer_sum(rest, h);
    for (int a = 0; a < kCorners; ++a)
      for (int l = 0; l < 3; ++l)
        gamma_.at[a][l] =
            N(1.0 / kCorners) * (h.at[a][l] - dot(mean_gradient.at[a], column(moments, l).at));  //             eq. E8

    mean_ = safe_polar(outer_sum(current, mean_gradient) * plastic);  //                                    eq. E9, P2
    turned_ = product_transposed(mean_.R, plastic);
    const Mat<N> j = product_transposed(turned_, J_inverse_);  // columns j_n
    for (int n = 0; n < 3; ++n)
      for (const int m : {(n + 1) % 3, (n + 2) % 3}) {
        const Column<N> j_n = column(j, n), j_m = column(j, m);
        const N inverse = N(1.0) / dot(j_n.at, j_n.at), alpha = inverse * dot(j_n.at, j_m.at);
        Mat<N>& of = of_hourglass_[n][3 - n - m];
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c)
            of(r, c) = N(r == c ? -1.0 : 0.0) * alpha - inverse * (j_m.at[r] - alpha * j_n.at[r]) * j_n.at[c];
      }
  }

  /// A_n, as columns.                                                                                          eq. E10
  HEXAPLAST_INLINE Mat<N> columns(const CornerLanes<N>& u) const { return assumed(hourglass(u)); }

  /// c sum_n s_n A_n (x) J^n at sample i.                                                                      eq. E11c
  HEXAPLAST_INLINE Mat<N> gradient(const Mat<N>& A, int sample) const { return signed_columns(A, sample) * J_inverse_; }

  /// The transpose: adds what stresses P_i act with on u, per corner.
  HEXAPLAST_NOINLINE void add_transpose(const Mat<N> (&P)[kCorners], CornerLanes<N>& acting) const {
    add_products(on_hourglass(on_assumed(P)), gamma_, acting);
  }

  /// The same by way of R, which turns with u.                                                           eq. E12, E13
  HEXAPLAST_NOINLINE void add_turning(const Mat<N> (&P)[kCorners], const CornerLanes<N>& u,
                                      const CornerLanes<N>& mean_gradient, CornerLanes<N>& acting) const {
    const Mat<N> q = hourglass(u), A = assumed(q), g = on_assumed(P), h = on_hourglass(g);
    Column<N> M = {{N(0.0), N(0.0), N(0.0)}};  //                                                               eq. E12
    for (int n = 0; n < 3; ++n) {
      const Column<N> of_assumed = cross(column(A, n), column(g, n)), of_modes = cross(column(q, n), column(h, n));
      for (int k = 0; k < 3; ++k) M.at[k] += of_assumed.at[k] - of_modes.at[k];
    }
    const Column<N> y = mean_.R * (inverse_of_turning() * (transposed(mean_.R) * M));  //                       eq. E13
    for (int a = 0; a < kCorners; ++a) {
      const Column<N> Gm = {{mean_gradient.at[a][0], mean_gradient.at[a][1], mean_gradient.at[a][2]}};
      const Column<N> moved = cross(y, turned_ * Gm);
      for (int k = 0; k < 3; ++k) acting.at[a][k] += moved.at[k];
    }
  }

 private:
  HEXAPLAST_INLINE Mat<N> hourglass(const CornerLanes<N>& u) const { return outer_sum(u, gamma_); }  // columns q_l

  HEXAPLAST_NOINLINE Mat<N> assumed(const Mat<N>& q) const {
    Mat<N> A;
    for (int n = 0; n < 3; ++n) {
      const int l = (n + 1) % 3, m = (n + 2) % 3;
      const Column<N> of_l = of_hourglass_[n][l] * column(q, l), of_m = of_hourglass_[n][m] * column(q, m);
      for (int k = 0; k < 3; ++k) A(k, n) = of_l.at[k] + of_m.at[k];
    }
    return A;
  }

  // c s_n in column n
  HEXAPLAST_INLINE Mat<N> signed_columns(const Mat<N>& A, int sample) const {
    Mat<N> out;
    for (int n = 0; n < 3; ++n)
      for (int k = 0; k < 3; ++k) out(k, n) = N(static_cast<double>(kCornerSign[sample][n])) * weight_ * A(k, n);
    return out;
  }

  // columns g_n
  HEXAPLAST_NOINLINE Mat<N> on_assumed(const Mat<N> (&P)[kCorners]) const {
    Mat<N> g;
    set_zero(g);
    for (int i = 0; i < kCorners; ++i) g = g + signed_columns(product_transposed(P[i], J_inverse_), i);
    return g;
  }

  // columns h'_l
  HEXAPLAST_NOINLINE Mat<N> on_hourglass(const Mat<N>& g) const {
    Mat<N> h;
    for (int l = 0; l < 3; ++l) {
      const int m = (l + 1) % 3, n = (l + 2) % 3;
      const Column<N> of_m = transposed(of_hourglass_[m][l]) * column(g, m),
                      of_n = transposed(of_hourglass_[n][l]) * column(g, n);
      for (int k = 0; k < 3; ++k) h(k, l) = of_m.at[k] + of_n.at[k];
    }
    return h;
  }

  // (tr S I - S)^-1, bounded where two stretches are opposite                                                  eq. E13
  HEXAPLAST_INLINE Mat<N> inverse_of_turning() const {
    const Sym<N>& S = mean_.S;
    const N trace = S.xx + S.yy + S.zz;
    const Mat<N> K = matrix(Sym<N>{trace - S.xx, trace - S.yy, trace - S.zz, -S.yz, -S.zx, -S.xy}), cof = cofactor(K);
    const N least = N(1e-9) * (cof(0, 0) + cof(1, 1) + cof(2, 2));
    return scaled(N(1.0) / max(max(determinant(K), least), N(1e-30)), cof);
  }

  N weight_;
  Mat<N> J_inverse_;           // rows J^n [1/m]
  PolarLanes<N> mean_;         // of the mean gradient F_m, times Gm of isolated rest shapes
  Mat<N> turned_;              // R Gm^T
  CornerLanes<N> gamma_;       // column l: gamma_l                                                 eq. E8
  Mat<N> of_hourglass_[3][3];  // A_n = sum_l of_hourglass_[n][l] q_l; none where l = n            eq. E10
};

/// What a hexahedron of isolated rest shapes, and one with viscoelastic branches, has besides its corners.
template <class N>
struct ElementState {
  const Mat<N>* plastic_inverse = nullptr;   ///< G_i; null: 1
  const BranchLanes<N>* branches = nullptr;  ///< null: none
};

/// q + A of a single sample.                                                                            eq. P14, P15
template <std::same_as<double> N>
HEXAPLAST_INLINE Mat<N> balanced_stress(const Sym<N>& q, const PolarLanes<N>& polar) {
  return bounded_balance(q, polar.S);
}

/// One hexahedron at one set of current positions, or one in each lane.
template <class N>
class Element {
 public:
  /// Corners [m], moduli [Pa].
  HEXAPLAST_NOINLINE void set(const CornerLanes<N>& rest, const CornerLanes<N>& current, N mu, N lambda,
                              const Settings& settings, const ElementState<N>& state) {
    law_ = settings.law;
    mooney_fraction_ = settings.mooney_fraction;
    mu_ = mu;
    const Sampling sampling = sampling_of(settings);
    EdgeLanes<N> e;
    edges(rest, e);
    gradients_.set(e, sampling);
    has_flowed_ = state.plastic_inverse != nullptr;
    for (int i = 0; has_flowed_ && i < kCorners; ++i) assign(state.plastic_inverse[i], plastic_inverse_[i]);
    assumes_ = sampling.assumes_strain;
    if (assumes_)
      assumed_.set(rest, gradients_.mean, current, sampling.corner_weight,
                   has_flowed_ ? mean_plastic_inverse(plastic_inverse_) : identity());
    current_ = current;

    gradients(current, F);  //                                                                      eq. 7, E11c, P1
    const N none(0.0);
    mean_dilatation_ = none;
    for (int i = 0; i < kCorners; i += kAtOnce) safe_polars<kAtOnce>(F + i, polar + i);  //                      eq. 6
    for (int i = 0; i < kCorners; ++i) {
      dilatation_[i] = dilatation(law_, polar[i].S);
      mean_dilatation_ += N(1.0 / kCorners) * dilatation_[i];
    }

    // what resists a change of volume                                                        eq. E2 to E5, E14 to E18
    const LawConstants<N> constants(law_, mooney_fraction_, mu);
    has_volume_ = settings.volumetric == Volumetric::kVolumeRatio;
    free_ = has_volume_ ? free_modulus(mu, lambda) : lambda;  //                                               eq. E2
    k0_ = constants.k0;
    own_ = constants.b0 + free_;
    shared_ = of_volume_ = volume_excess = none;
    if (has_volume_) {
      const bool is_corotated = law_ == ElasticLaw::kCorotated;
      if (is_corotated) shared_ = -free_;  // of the mean dilatation
      of_volume_ = is_corotated ? lambda : lambda - free_;
      N now;
      edges(current, e);
      volume_gradient(e, volume_gradient_, now);
      volume_excess = now / gradients_.volume - N(1.0);
      volume_gradient_ = scaled(now / gradients_.volume, volume_gradient_);
    }
    for (int i = 0; law_ != ElasticLaw::kCorotated && i < kCorners; ++i) {
      guard_[i] = tangent_guard(law_, mooney_fraction_, polar[i].S, mu, pressure(i) + of_volume_ * volume_excess);
      along_dilatation_[i] = cofactor(F[i]);
    }

    branches_ = state.branches != nullptr;
    branch_energy_ = none;
    if (branches_) {
      branch_modulus_ = state.branches->modulus;
      branch_weight_ = state.branches->weight;
      Sym<N> D[kCorners];
      state.branches->changes([&](int i) { return polar[i].S; }, D);
      for (int i = 0; i < kCorners; ++i) {
        branch_stress_[i] = balanced_stress(state.branches->stress(i, D[i]), polar[i]);
        branch_energy_ += N(1.0 / kCorners) * state.branches->energy(i, D[i]);  //                            eq. P17
      }
    }
  }

  /// [J]                                                                                           eq. 18, E5, E14, P17
  HEXAPLAST_NOINLINE N energy() const {
    const N half(0.5);
    N density = branch_energy_ +
                half * (shared_ * mean_dilatation_ * mean_dilatation_ + of_volume_ * volume_excess * volume_excess);
    for (int i = 0; i < kCorners; ++i) {
      const N theta = dilatation_[i];
      density += N(1.0 / kCorners) *
                 (shape_energy(law_, mooney_fraction_, polar[i].S, mu_) + (k0_ + half * own_ * theta) * theta);
    }
    return gradients_.volume * density;
  }

  /// [N] per corner                                                              eq. 15, E3, E6, E13, E15, P14
  HEXAPLAST_NOINLINE CornerLanes<N> force() const {
    Mat<N> P[kCorners];
    for (int i = 0; i < kCorners; ++i) {
      const Mat<N> sigma = matrix(stress(law_, mooney_fraction_, polar[i].S, mu_, pressure(i)));
      P[i] = polar[i].R * (branches_ ? sigma + branch_stress_[i] : sigma);  //                           eq. 12, 13, P14
    }
    CornerLanes<N> acting = transpose(P);
    if (assumes_) assumed_.add_turning(P, current_, gradients_.mean, acting);
    acting = scaled(N(1.0 / kCorners), acting);
    if (has_volume_) add(scaled(of_volume_ * volume_excess, volume_gradient_), acting);
    return scaled(-gradients_.volume, acting);
  }

  /// [N] per corner, rotations fixed                                                            eq. 16, E4, E7, E20
  HEXAPLAST_NOINLINE CornerLanes<N> force_increment(const CornerLanes<N>& dx) const {
    Mat<N> dF[kCorners];
    gradients(dx, dF);
    N t[kCorners], mean(0.0);  // increments of the dilatations
    for (int i = 0; i < kCorners; ++i) {
      t[i] = dot(along_dilatation(i), dF[i]);
      mean += N(1.0 / kCorners) * t[i];
    }
    for (int i = 0; i < kCorners; ++i) {
      const Mat<N>& R = polar[i].R;
      const Mat<N> Z = transposed_product(R, dF[i]);
      Mat<N> local = stress_increment(Z, mu_, N(0.0));  // R^T dP
      N pressure = free_ * t[i] + shared_ * mean;
      if (branches_) {
        local = local + stress_increment(Z, branch_modulus_, N(0.0));
        pressure += N(2.0) * branch_modulus_ * (branch_weight_ * (t[i] - mean) - N(1.0 / 3) * mean);
      }
      if (law_ == ElasticLaw::kCorotated) {
        for (int k = 0; k < 3; ++k) local(k, k) += pressure;
        dF[i] = R * local;
      } else {
        dF[i] = R * local + (scaled(pressure, along_dilatation_[i]) + scaled(guard_[i], dF[i]));
      }
    }
    CornerLanes<N> acting = scaled(N(1.0 / kCorners), transpose(dF));
    if (has_volume_) {
      N change(0.0);  // of the volume ratio
      for (int a = 0; a < kCorners; ++a) change += dot(volume_gradient_.at[a], dx.at[a]);
      add(scaled(of_volume_ * change, volume_gradient_), acting);
    }
    return scaled(-gradients_.volume, acting);
  }

  /// [Pa] The stress that yields: it contains the pressure of the volume ratio.                           eq. E19
  HEXAPLAST_INLINE Sym<N> yielding_stress(int sample) const {
    return stress(law_, mooney_fraction_, polar[sample].S, mu_, pressure(sample) + volume_pressure());
  }
  HEXAPLAST_INLINE N volume_pressure() const { return of_volume_ * volume_excess; }  ///< [Pa]
  HEXAPLAST_INLINE const SampleGradients<N>& sample_gradients() const { return gradients_; }
  HEXAPLAST_INLINE N volume() const { return gradients_.volume; }              ///< [m^3] of the rest shape
  HEXAPLAST_INLINE N jacobian(int i) const { return gradients_.jacobian[i]; }  ///< [m^3] of the rest shape

  Mat<N> F[kCorners];  ///< of isolated rest shapes F^e
  PolarLanes<N> polar[kCorners];
  N volume_excess;  ///< beta^ - 1

 private:
  static HEXAPLAST_INLINE Mat<N> identity() {
    const N one(1.0), none(0.0);
    return {{{one, none, none}, {none, one, none}, {none, none, one}}};
  }
  HEXAPLAST_INLINE N pressure(int sample) const {
    return k0_ + own_ * dilatation_[sample] + shared_ * mean_dilatation_;
  }
  HEXAPLAST_INLINE const Mat<N>& along_dilatation(int sample) const {  // d theta / d F
    return law_ == ElasticLaw::kCorotated ? polar[sample].R : along_dilatation_[sample];
  }

  HEXAPLAST_NOINLINE void gradients(const CornerLanes<N>& u, Mat<N> (&to)[kCorners]) const {
    Mat<N> A;
    if (assumes_) A = assumed_.columns(u);
    gradients_.gradients(u, to);
    for (int i = 0; i < kCorners; ++i) {
      if (assumes_) to[i] = to[i] + assumed_.gradient(A, i);
      if (has_flowed_) to[i] = to[i] * plastic_inverse_[i];
    }
  }

  // of P^e                                                                                                    eq. P4
  HEXAPLAST_NOINLINE CornerLanes<N> transpose(Mat<N> (&P)[kCorners]) const {
    for (int i = 0; has_flowed_ && i < kCorners; ++i) P[i] = product_transposed(P[i], plastic_inverse_[i]);
    CornerLanes<N> acting = gradients_.transpose(P);
    if (assumes_) assumed_.add_transpose(P, acting);
    return acting;
  }

  ElasticLaw law_;
  bool has_flowed_, assumes_, has_volume_, branches_;
  double mooney_fraction_;
  N mu_;
  CornerLanes<N> current_;
  SampleGradients<N> gradients_;
  AssumedStrain<N> assumed_;
  Mat<N> plastic_inverse_[kCorners];

  N dilatation_[kCorners], mean_dilatation_;  // theta_i
  Mat<N> along_dilatation_[kCorners];         // of the other laws
  N guard_[kCorners];                         // [Pa] beta_i of the same                                        eq. E21
  N k0_, own_, shared_;                       // [Pa] pressures k_i = k0 + own theta_i + shared mean theta
  N free_;       // [Pa] lambda_f                                                                       eq. E2
  N of_volume_;  // [Pa] modulus of the volume ratio
  CornerLanes<N> volume_gradient_;  // [1/m] b_a                                                                eq. E6

  Mat<N> branch_stress_[kCorners];    // [Pa] what R takes to their part of P^e                                  eq. P14
  N branch_modulus_, branch_weight_;  // [Pa] mu_b; w
  N branch_energy_;                   // [J/m^3] mean of the samples                                             eq. P17
};

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
