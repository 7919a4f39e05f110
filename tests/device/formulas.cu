// SPDX-License-Identifier: LGPL-2.1-or-later
// The formulas as device code, of single numbers: one kernel for each, which scripts/check_device compiles. Nothing
// runs.
#define HEXAPLAST_ONE_NUMBER

#ifndef __CUDACC__   // clang, without headers of CUDA's
#include <stdlib.h>  // before its <new>, which names malloc
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))
#define __global__ __attribute__((global))
#endif

#include "elastic/assumed-inl.hpp"
#include "element/element-inl.hpp"
#include "element/isolated-inl.hpp"
#include "element/relaxation-inl.hpp"
#include "kinematics/polar-inl.hpp"
#include "kinematics/rotation-inl.hpp"
#include "material/law-inl.hpp"
#include "plastic/point_flow-inl.hpp"

namespace hexaplast::one_number {

using N = float;

__global__ void closed_polar(const Mat<N>* F, PolarLanes<N>* polar) {
  PolarLanes<N> out[1];
  polars<1>(F, out);
  *polar = out[0];
}
__global__ void singular_values(const Mat<N>* F, SvdOf<N>* svd) { *svd = signed_svd(*F); }
__global__ void any_polar(const Mat<N>* F, PolarLanes<N>* polar) { *polar = safe_polar(*F); }

__global__ void laws(ElasticLaw law, double mooney_fraction, const Sym<N>* S, N mu, N k, Sym<N>* sigma, N* numbers) {
  *sigma = dissipating(law, *S, stress(law, mooney_fraction, *S, mu, k));
  numbers[0] = dilatation(law, *S);
  numbers[1] = tangent_guard(law, mooney_fraction, *S, mu, k);
  numbers[2] = stress_norm_bound(*sigma, YieldNorm::kVonMises);
}
__global__ void energy(const MaterialLanes<N>* of, const SampleLanes<N>* element, const CornerLanes<N>* u, N* density) {
  ModeLanes<N> gradient;
  *density = mean_energy_density(*of, *element, pressures(*of, *element, *u, gradient));
}
__global__ void rotation_power(const Mat<N>* R, N fraction, Mat<N>* power, std::uint32_t* fails) {
  const RotationVector<N> w = rotation_log(*R);
  *power = rotation_expm1(w, fraction);
  *fails = w.near_half_turn;
}

__global__ void gradients(const CornerLanes<N>* x, Sampling sampling, RestLanes<true, N>* rest) {
  rest_operator(*x, sampling, *rest);
}
__global__ void columns(const CornerLanes<N>* u, const Mat<N>* j, N corner_weight, Mat<N>* columns) {
  ModeLanes<N> at;
  modes(*u, at);
  N a[3][3];
  AssumedLanes<N>(*j, corner_weight).columns(at.at + 3, a);
  columns_of_modes(at.at, at.at + 3, a, corner_weight, columns);
}
__global__ void columns_transpose(const Mat<N>* columns, const Mat<N>* j, N corner_weight, CornerLanes<N>* f) {
  ModeLanes<N> at;
  N a[3][3];
  modes_of_columns(columns, corner_weight, a, at.at, at.at + 3);
  AssumedLanes<N>(*j, corner_weight).add_transpose(a, at.at + 3);
  modes_transpose(at, *f);
}
__global__ void volume(const CornerLanes<N>* x, ModeLanes<N>* gradient, N* volume) {
  ModeLanes<N> at;
  modes(*x, at);
  *volume = volume_of(at, *gradient);
}

template <bool kGeneral>
HEXAPLAST_INLINE void sample(const CornerLanes<N>* x, const CornerLanes<N>* u, Sampling sampling,
                             const PlasticLanes<N>* plastic, SampleLanes<N>* samples) {
  ElementLanes<kGeneral, N> element;
  place_element(*x, *u, sampling, plastic, element);
  decompose(element);
  *samples = element;
}
__global__ void boxes(const CornerLanes<N>* x, const CornerLanes<N>* u, Sampling sampling,
                      const PlasticLanes<N>* plastic, SampleLanes<N>* samples) {
  sample<false>(x, u, sampling, plastic, samples);
}
__global__ void general_elements(const CornerLanes<N>* x, const CornerLanes<N>* u, Sampling sampling,
                                 const PlasticLanes<N>* plastic, SampleLanes<N>* samples) {
  sample<true>(x, u, sampling, plastic, samples);
}
__global__ void turning_mean(const PolarLanes<N>* mean, const Mat<N>* j, const N (*M)[3], Mat<N>* rows) {
  *rows = turning(*mean, *j, *M);
}

__global__ void product(const StoredHalf* coef, StiffnessKind kind, const N* weight, N factor, CornerLanes<N>* u) {
  CornerLanes<N> at = *u;
  apply_stiffness<false>(StoredElement<false, const StoredHalf, 1>(coef), kind, {weight}, factor, at);
  *u = at;
}

__global__ void point_flow(const Sym<N>* S, const Sym<N>* sigma, N threshold, N hardening, N rate_dt, Mat<N>* increment,
                           N* numbers, std::uint32_t* fails) {
  const N norm = stress_norm_bound(*sigma, YieldNorm::kVonMises);
  const N fraction = flow_fraction(norm, threshold, rate_dt, norm);
  N strain = 0, dissipated = 0;
  *increment = stretch_increment(*S, *sigma, fraction, strain, dissipated, *fails);
  numbers[0] = strain;
  numbers[1] = dissipated;
  numbers[2] = hardened(threshold, hardening, fraction, norm);
  numbers[3] = restitution_scale(determinant(*increment), rate_dt);
}

__global__ void relief(const Mat<N> (*G)[kCorners], const Mat<N>* J_inverse, Sym<N> (*A)[kCorners]) {
  Mat<N> normals[kCorners];
  Sym<N> relieved[kCorners];
  for (int i = 0; i < kCorners; ++i) {
    normals[i] = face_normals((*G)[i], *J_inverse);
    relieved[i] = (*A)[i];
  }
  relieve(normals, relieved);
  for (int i = 0; i < kCorners; ++i) (*A)[i] = relieved[i];
}
__global__ void isolated_flow(const Mat<N>* G, const Sym<N>* S, const Sym<N>* sigma, const Sym<N>* relieved,
                              N threshold, N rate_dt, N mu, Mat<N>* flowed, std::uint32_t* fails) {
  const Sym<N> whole = cauchy_stress(*S, *sigma, N(0), N(1));
  const N fraction = isolated_flow_fraction(stress_norm_bound(*relieved, YieldNorm::kVonMises), threshold, rate_dt);
  const Sym<N> log = symmetric_part(deviatoric_log(*S, *fails));
  *flowed = flowed_plastic_inverse(*G, flow_direction(log, *relieved, whole, mu, fraction));
}
__global__ void mean_inverse(const Mat<N> (*G)[kCorners], Mat<N>* mean) { *mean = mean_plastic_inverse(*G); }

__global__ void branches(const Sym<N>* q, const Sym<N>* S, N mu, N lambda, N g, Mat<N>* balanced, Mat<N>* bounded) {
  const Sym<N> whole = branch_stress(branch_free_modulus(mu, lambda, g) / g, *q);
  *balanced = in_balance(whole, *S);
  *bounded = bounded_balance(whole, *S);
}

}  // namespace hexaplast::one_number
