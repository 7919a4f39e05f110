// SPDX-License-Identifier: LGPL-2.1-or-later
// The elastic element: samples, stresses, force, energy and stiffness, for elements in lanes and for one element.
//                                                                                          theory.md sections 2, 3, 9.3
#if defined(HEXAPLAST_ELEMENT_ELEMENT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_ELEMENT_ELEMENT_INL
#undef HEXAPLAST_ELEMENT_ELEMENT_INL
#else
#define HEXAPLAST_ELEMENT_ELEMENT_INL
#endif

#include "kinematics/columns-inl.hpp"
#include "material/law-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Calls f.template operator()<general>() for what an element is.
template <class F>
HEXAPLAST_INLINE void for_shape(bool is_general, const F& f) {
  return is_general ? f.template operator()<true>() : f.template operator()<false>();
}

/// The plastic deformation of isolated rest shapes.                                                            eq. P2
template <class N>
struct PlasticLanes {
  Mat<N> inverse[kCorners];  ///< G_i
  Mat<N> mean;               ///< Gm
};

/// The samples of an element at current positions.
template <class N>
struct SampleLanes {
  Mat<N> F[kCorners];
  PolarLanes<N> polar[kCorners];
  PolarLanes<N> mean;  ///< R_m and S_m of the mean gradient
  N volume;            ///< [m^3] of the plastic rest shape
  N min_jacobian;      ///< [m^3] of the plastic rest shape at its corners
};

/// And how they follow from the corners.
template <bool kGeneral, class N>
struct ElementLanes : SampleLanes<N> {
  RestLanes<kGeneral, N> rest;
  ColumnLanes<kGeneral, N> columns;
  Mat<N> j;                                  ///< rows R_m Gm^T J^n / 2
  const PlasticLanes<N>* plastic = nullptr;  ///< null: 1
  Mat<N> elastic_inverse[kCorners];          ///< with it: J_i^-1 G_i / 2
};

template <bool kGeneral, class N>
HEXAPLAST_INLINE const Mat<N>& inverse_at(const RestLanes<kGeneral, N>& rest, int sample) {
  return rest.inverse[kGeneral ? sample : 0];
}
/// What takes the columns of a sample to its gradient F~, or F^e.
template <bool kGeneral, class N>
HEXAPLAST_INLINE const Mat<N>& inverse_at(const ElementLanes<kGeneral, N>& element, int sample) {
  return element.plastic ? element.elastic_inverse[sample] : inverse_at(element.rest, sample);
}
/// J_o^-1 / 2
template <bool kGeneral, class N>
HEXAPLAST_INLINE const Mat<N>& dual_of(const RestLanes<kGeneral, N>& rest) {
  if constexpr (kGeneral)
    return rest.dual;
  else
    return rest.inverse[0];
}

/// What the samples follow from, at current positions u: the plastic rest shape and the mean gradient with its polar
/// decomposition. mean_plastic: Gm, or null: 1.
template <bool kGeneral, class N>
HEXAPLAST_INLINE void place_mean(const CornerLanes<N>& x, const CornerLanes<N>& u, const Sampling& sampling,
                                 const Mat<N>* mean_plastic, ElementLanes<kGeneral, N>& element) {
  auto& rest = element.rest;
  auto& columns = element.columns;
  rest_operator(x, sampling, rest);
  element.volume = rest.volume;
  element.min_jacobian = rest.min_jacobian;
  begin_columns(rest, u, columns);
  Mat<N> dual;
  assign(mean_plastic ? dual_of(rest) * *mean_plastic : dual_of(rest), dual);
  const Mat<N> F_m = transposed_product(columns.mean, dual);
  safe_polars<1>(&F_m, &element.mean);
  assign(product_transposed(dual, element.mean.R), element.j);
}

/// Gradients of the samples at current positions u; the polar decompositions are left to the caller. plastic: null, or
/// of isolated rest shapes, to stay as long as the element.                                            eq. 7, E11c, P1
template <bool kGeneral, class N>
HEXAPLAST_NOINLINE void place_element(const CornerLanes<N>& x, const CornerLanes<N>& u, const Sampling& sampling,
                                      const PlasticLanes<N>* plastic, ElementLanes<kGeneral, N>& element) {
  auto& rest = element.rest;
  auto& columns = element.columns;
  place_mean(x, u, sampling, plastic ? &plastic->mean : nullptr, element);
  element.plastic = plastic;
  finish_columns(rest, u, AssumedLanes<N>(element.j, rest.corner_weight), columns);
  for (int i = 0; i < kCorners; ++i) {
    Mat<N>& F = element.F[i];
    if (plastic) assign(inverse_at(rest, i) * plastic->inverse[i], element.elastic_inverse[i]);
    F = transposed_product(columns_at(columns, i), inverse_at(element, i));
    if constexpr (kGeneral) {
      Mat<N> H = shared_at(columns, i);
      if (plastic) H = H * plastic->inverse[i];
      for (int k = 0; k < 9; ++k) F.m[k / 3][k % 3] += H.m[k / 3][k % 3];
    }
  }
}

/// Rotations and stretches of all samples.                                                                     eq. 6
template <class N>
HEXAPLAST_NOINLINE void decompose(SampleLanes<N>& element) {
  for (int first = 0; first < kCorners; first += kAtOnce) {
    safe_polars<kAtOnce>(element.F + first, element.polar + first);
  }
}

/// lambda_f, the modulus of a sample's own dilatation.                                                     eq. E2
template <class N>
HEXAPLAST_INLINE N free_modulus(N mu, N lambda) {
  using T = ScalarOf<N>;
  const N twice = mu + mu;  // of both signs: operators are added and subtracted; absent elements have neither
  return twice * (abs(lambda) / max(abs(lambda + twice), N(T(1e-30))));
}

/// What an element is made of, and how its pressures are found.
template <class N>
struct MaterialLanes {
  HEXAPLAST_INLINE MaterialLanes(const Settings& settings, N mu_, N lambda_)
      : law(settings.law),
        mooney_fraction(settings.mooney_fraction),
        mu(mu_),
        lambda(lambda_),
        free(free_modulus(mu_, lambda_)) {}

  /// The modulus of the volume ratio: the corotated law's deviations have theirs about the mean.
  HEXAPLAST_INLINE N of_volume() const { return law == ElasticLaw::kCorotated ? lambda : lambda - free; }

  ElasticLaw law;
  double mooney_fraction;
  N mu, lambda, free;  ///< [Pa]
};

/// Pressures of the samples: k_i = k0 + own theta_i + shared.                                eq. E3, E5, E14, E15
template <class N>
struct PressureLanes {
  N own, k0;     ///< [Pa]
  N shared;      ///< [Pa] in the forces of the samples
  N in_stress;   ///< [Pa] in the stress that yields: with the pressure of the volume ratio
  N dilatation;  ///< mean of theta
  N excess;      ///< of the volume ratio: beta^ - 1

  HEXAPLAST_INLINE N at(N theta) const { return k0 + own * theta + shared; }
  HEXAPLAST_INLINE N in_stress_at(N theta) const { return k0 + own * theta + in_stress; }
};

/// Of the mean of theta; gradient: of the current volume.
template <class N>
HEXAPLAST_NOINLINE PressureLanes<N> pressures(const MaterialLanes<N>& of, N mean_dilatation, N volume,
                                              const CornerLanes<N>& u, ModeLanes<N>& gradient) {
  using T = ScalarOf<N>;
  PressureLanes<N> p;
  const LawConstants<N> law(of.law, of.mooney_fraction, of.mu);
  p.k0 = law.k0;
  p.own = law.b0 + of.free;
  p.shared = N(T(0));
  p.dilatation = mean_dilatation;
  ModeLanes<N> at;
  modes(u, at);
  p.excess = volume_of(at, gradient) / volume - N(T(1));
  if (of.law == ElasticLaw::kCorotated) p.shared = -(of.free * p.dilatation);
  p.in_stress = p.shared + of.of_volume() * p.excess;
  return p;
}

template <class N>
HEXAPLAST_INLINE PressureLanes<N> pressures(const MaterialLanes<N>& of, const SampleLanes<N>& element,
                                            const CornerLanes<N>& u, ModeLanes<N>& gradient) {
  using T = ScalarOf<N>;
  N sum(T(0));
  for (const PolarLanes<N>& polar : element.polar) sum += dilatation(of.law, polar.S);
  return pressures(of, N(T(1.0 / kCorners)) * sum, element.volume, u, gradient);
}

/// Elastic energy over the volume of the plastic rest shape.                                         eq. E5, E14
template <class N>
HEXAPLAST_INLINE N mean_energy_density(const MaterialLanes<N>& of, const SampleLanes<N>& element,
                                       const PressureLanes<N>& p) {
  using T = ScalarOf<N>;
  N sum(T(0));
  for (const PolarLanes<N>& polar : element.polar) {
    const N theta = dilatation(of.law, polar.S);
    sum += shape_energy(of.law, of.mooney_fraction, polar.S, of.mu) + (p.k0 + N(T(0.5)) * p.own * theta) * theta;
  }
  return N(T(1.0 / kCorners)) * sum + N(T(0.5)) * (p.shared * p.dilatation + (p.in_stress - p.shared) * p.excess);
}

/// M += sum_n factor a_n x acting_n: the moment of what acts on these columns or modes.                        eq. E12
template <int kCount, class N>
HEXAPLAST_INLINE void add_moment(double factor, const N (&a)[kCount][3], const N (&acting)[kCount][3], N (&M)[3]) {
  for (int n = 0; n < kCount; ++n) add_cross(N(ScalarOf<N>(factor)), a[n], acting[n], M);
}

/// What the turning of R_m with the corners, of which the moment is M, adds to dE/dF_m: [y]x R_m Gm^T, times 2 J_o^-T,
/// as rows that act on F_m 2 J_o. j: rows R_m Gm^T J^n / 2.                                                  eq. E13
template <class N>
HEXAPLAST_NOINLINE Mat<N> turning(const PolarLanes<N>& mean, const Mat<N>& j, const N (&M)[3]) {
  using T = ScalarOf<N>;
  const Mat<N>& R = mean.R;
  const Sym<N>& S = mean.S;
  // (tr S - S)^-1 by its cofactors; where two stretches are opposite it is bounded
  const N trace = S.xx + S.yy + S.zz;
  const Mat<N> K = matrix(Sym<N>{trace - S.xx, trace - S.yy, trace - S.zz, -S.yz, -S.zx, -S.xy});
  const Mat<N> cof = cofactor(K);
  const N det = K(0, 0) * cof(0, 0) + K(0, 1) * cof(0, 1) + K(0, 2) * cof(0, 2);
  const N lowest = N(T(1e-9)) * (cof(0, 0) + cof(1, 1) + cof(2, 2));
  const N inverse = N(T(1)) / max(max(det, lowest), N(T(1e-30)));
  N local[3], turned[3];
  for (int k = 0; k < 3; ++k) local[k] = R(0, k) * M[0] + R(1, k) * M[1] + R(2, k) * M[2];
  for (int k = 0; k < 3; ++k)
    turned[k] = inverse * (cof(k, 0) * local[0] + cof(k, 1) * local[1] + cof(k, 2) * local[2]);
  N y[3];
  for (int k = 0; k < 3; ++k) y[k] = R(k, 0) * turned[0] + R(k, 1) * turned[1] + R(k, 2) * turned[2];
  Mat<N> rows;
  for (int n = 0; n < 3; ++n)
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3, l = (i + 2) % 3;
      rows(n, i) = y[k] * j(n, l) - y[l] * j(n, k);
    }
  return rows;
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
