// SPDX-License-Identifier: LGPL-2.1-or-later
// The elastic laws and the size of a stress, for samples in lanes and for one sample. theory.md section 3
#if defined(HEXAPLAST_MATERIAL_LAW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HEXAPLAST_MATERIAL_LAW_INL
#undef HEXAPLAST_MATERIAL_LAW_INL
#else
#define HEXAPLAST_MATERIAL_LAW_INL
#endif

#include <numbers>

#include "base/elementary-inl.hpp"
#include "base/lanes-inl.hpp"
#include "base/matrix-inl.hpp"
#include "hexaplast/material/material.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

// All laws are isotropic, so that they are functions of the stretch S of F = R S alone:
//
//   psi = psi_s(S) + k0 theta + (b0 + lambda_f) / 2 theta^2     energy density [J/m^3], the volume's part apart
//   sigma = d psi / dS = d psi_s / dS + k d theta / dS          stress in the material frame [Pa]
//   P = R sigma                                                 first Piola stress [Pa], the gradient of psi
//
// with the dilatation theta = tr S - 3 of the corotated law and det S - 1 of the others. k is the pressure that the
// element finds for the sample (element-inl.hpp): k0 + (b0 + lambda_f) theta + what all samples share.

template <class N>
HEXAPLAST_INLINE N trace(const Sym<N>& S) {
  return S.xx + S.yy + S.zz;
}
template <class N>
HEXAPLAST_INLINE N squared_norm(const Sym<N>& S) {
  return S.xx * S.xx + S.yy * S.yy + S.zz * S.zz + N(ScalarOf<N>(2)) * (S.yz * S.yz + S.zx * S.zx + S.xy * S.xy);
}
template <class N>
HEXAPLAST_INLINE Sym<N> cofactor(const Sym<N>& S) {
  return {S.yy * S.zz - S.yz * S.yz, S.zz * S.xx - S.zx * S.zx, S.xx * S.yy - S.xy * S.xy,
          S.zx * S.xy - S.xx * S.yz, S.xy * S.yz - S.yy * S.zx, S.yz * S.zx - S.zz * S.xy};
}
template <class N>
HEXAPLAST_INLINE N determinant(const Sym<N>& S) {
  return S.xx * (S.yy * S.zz - S.yz * S.yz) + S.xy * (S.yz * S.zx - S.zz * S.xy) + S.zx * (S.xy * S.yz - S.yy * S.zx);
}

/// theta.
template <class N>
HEXAPLAST_INLINE N dilatation(ElasticLaw law, const Sym<N>& S) {
  if (law == ElasticLaw::kCorotated) return trace(S) - N(ScalarOf<N>(3));
  return determinant(S) - N(ScalarOf<N>(1));
}

/// Constants k0 and b0 of a law that make it agree with Hooke's in the small.                    eq. E16, E17, E18
template <class N>
struct LawConstants {
  HEXAPLAST_INLINE LawConstants(ElasticLaw law, double mooney_fraction, N mu) : k0(ScalarOf<N>(0)), b0(ScalarOf<N>(0)) {
    using T = ScalarOf<N>;
    switch (law) {
      case ElasticLaw::kCorotated:
        break;
      case ElasticLaw::kNeoHookean:
        k0 = -mu, b0 = mu;
        break;
      case ElasticLaw::kStableNeoHookean:
        k0 = -mu, b0 = N(T(5.0 / 6)) * mu;
        break;
      case ElasticLaw::kMooneyRivlin:
        k0 = -(N(T(1 + mooney_fraction)) * mu), b0 = N(T(1 - mooney_fraction)) * mu;
        break;
    }
  }
  N k0, b0;  ///< [Pa]
};

/// psi_s.                                                                                   eq. 11, E16, E17, E18
template <class N>
HEXAPLAST_INLINE N shape_energy(ElasticLaw law, double mooney_fraction, const Sym<N>& S, N mu) {
  using T = ScalarOf<N>;
  if (law == ElasticLaw::kCorotated) {
    const N one(T(1)), xx = S.xx - one, yy = S.yy - one, zz = S.zz - one;
    return mu * (xx * xx + yy * yy + zz * zz + N(T(2)) * (S.yz * S.yz + S.zx * S.zx + S.xy * S.xy));
  }
  const N I = squared_norm(S), excess = I - N(T(3));
  if (law == ElasticLaw::kNeoHookean) return N(T(0.5)) * mu * excess;
  if (law == ElasticLaw::kStableNeoHookean) return N(T(2.0 / 3)) * mu * (excess - log((I + N(T(1))) * N(T(0.25))));
  const N of_cofactors = squared_norm(cofactor(S)) - N(T(3));
  return N(T(0.5)) * mu * (N(T(1 - mooney_fraction)) * excess + N(T(mooney_fraction)) * of_cofactors);
}

/// sigma; k: the sample's pressure.                                                              eq. 12, E15, E19
template <class N>
HEXAPLAST_INLINE Sym<N> stress(ElasticLaw law, double mooney_fraction, const Sym<N>& S, N mu, N k) {
  using T = ScalarOf<N>;
  if (law == ElasticLaw::kCorotated) {
    const N twice = mu + mu, one(T(1));
    return {twice * (S.xx - one) + k,
            twice * (S.yy - one) + k,
            twice * (S.zz - one) + k,
            twice * S.yz,
            twice * S.zx,
            twice * S.xy};
  }
  const Sym<N> cof = cofactor(S);
  N factor = mu;
  if (law == ElasticLaw::kStableNeoHookean) {
    const N one(T(1));
    factor = N(T(4.0 / 3)) * mu * (one - one / (squared_norm(S) + one));
  } else if (law == ElasticLaw::kMooneyRivlin) {
    factor = N(T(1 - mooney_fraction)) * mu;
  }
  Sym<N> sigma = {factor * S.xx + k * cof.xx, factor * S.yy + k * cof.yy, factor * S.zz + k * cof.zz,
                  factor * S.yz + k * cof.yz, factor * S.zx + k * cof.zx, factor * S.xy + k * cof.xy};
  if (law == ElasticLaw::kMooneyRivlin) {  // m2 (I S - S^3)
    const Mat<N> M = matrix(S), cube = M * M * M;
    const N second = N(T(mooney_fraction)) * mu, I = squared_norm(S);
    sigma.xx += second * (I * S.xx - cube(0, 0));
    sigma.yy += second * (I * S.yy - cube(1, 1));
    sigma.zz += second * (I * S.zz - cube(2, 2));
    sigma.yz += second * (I * S.yz - cube(1, 2));
    sigma.zx += second * (I * S.zx - cube(2, 0));
    sigma.xy += second * (I * S.xy - cube(0, 1));
  }
  return sigma;
}

/// The stress that does plastic work on the increments of log S: sigma itself where stress is small beside the moduli
/// (theory.md 5.8), Mandel's S sigma for the other laws.
template <class N>
HEXAPLAST_INLINE Sym<N> dissipating(ElasticLaw law, const Sym<N>& S, const Sym<N>& sigma) {
  if (law == ElasticLaw::kCorotated) return sigma;
  const Mat<N> M = matrix(S) * matrix(sigma);  // symmetric: both have the same axes
  return {M(0, 0), M(1, 1), M(2, 2), M(1, 2), M(2, 0), M(0, 1)};
}

/// 2 mu sym Z + lambda tr(Z) I: of Z = R^T dF it is R^T dP (eq. 14), of Z = dF R^T it is dP R^T (eq. 52).
template <class N>
HEXAPLAST_INLINE Mat<N> stress_increment(const Mat<N>& Z, N mu, N lambda) {
  const N trace = lambda * (Z(0, 0) + Z(1, 1) + Z(2, 2)), twice = mu + mu;
  Mat<N> P;
  for (int r = 0; r < 3; ++r) {
    P(r, r) = twice * Z(r, r) + trace;
    for (int c = 0; c < r; ++c) P(r, c) = P(c, r) = mu * (Z(r, c) + Z(c, r));
  }
  return P;
}

/// beta [Pa]: what holds the other laws where a sample is strained or inverted badly. It is nothing at rest, where it
/// would resist turns.                                                                                     eq. E21
template <class N>
HEXAPLAST_INLINE N tangent_guard(ElasticLaw law, double mooney_fraction, const Sym<N>& S, N mu, N k) {
  using T = ScalarOf<N>;
  const N none(T(0)), I = squared_norm(S);
  const N more = N(T(std::numbers::sqrt3)) * (abs(LawConstants<N>(law, mooney_fraction, mu).k0) - mu);
  const N guard = max(none, abs(k) * sqrt(I) - (mu + mu + more));
  if (law != ElasticLaw::kMooneyRivlin) return guard;
  return guard + N(T(mooney_fraction)) * mu * max(none, I - N(T(3)));
}

/// The stress norm of the yield condition; of the spectral norm, which takes eigenvalues, an upper bound.       eq. 20
template <class N>
HEXAPLAST_INLINE N stress_norm_bound(const Sym<N>& s, YieldNorm norm) {
  const N mean = norm == YieldNorm::kVonMises ? N(1.0 / 3) * (s.xx + s.yy + s.zz) : N(0.0);
  const N xx = s.xx - mean, yy = s.yy - mean, zz = s.zz - mean;
  const N squared = xx * xx + yy * yy + zz * zz + N(2.0) * (s.yz * s.yz + s.zx * s.zx + s.xy * s.xy);
  return sqrt(norm == YieldNorm::kVonMises ? N(1.5) * squared : squared);
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
