// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/element_pass.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/element_kernels-inl.hpp"
#include "elastic/element_pass.hpp"
#include "material/stress_norm-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

template <bool kGeneral, class T, class Coef>
HWY_INLINE void linearize_lanes(const ElementPass<T, Coef>& pass, int block, int lane) {
  using V = Lanes<double>;
  const std::uint32_t present = static_cast<std::uint32_t>(pass.present[block]) >> lane;
  CornerLanes<V> x, u;
  gather(pass.partition, block, lane, pass.material, x);
  gather(pass.partition, block, lane, pass.world, u);
  replace_absent(present, x);
  replace_absent(present, u);
  RestLanes<kGeneral, V> rest;
  rest_operator(x, pass.gradient, rest);
  const GradientLanes<kGeneral, V> gradient(rest, u);
  const V share = rest.share;
  const V volume = select_bits(present, rest.volume, V(0.0));
  store(volume, pass.volume + static_cast<std::size_t>(block) * kBlock + lane);

  const double* lame = pass.lame + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  const V mu = load(lame), lambda = load(lame + kBlock);
  const V eighth = V(-1.0 / kCorners) * volume;
  float* screen = pass.screen + static_cast<std::size_t>(block) * YieldScreen::kQuantities * kBlock + lane;
  auto* coef = reinterpret_cast<typename Stored<Coef>::type*>(pass.op.coef.data() + pass.op.offset[block]) + lane;
  T* weight = pass.op.weight.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  const V per_sample = V(1 / (kCorners * pass.length * pass.length)) * volume;
  store_as(per_sample * mu, weight);
  store_as(per_sample * lambda, weight + kBlock);
  const V length(pass.length);

  Mat<V> R_centre = rest.inverse[0];  // overwritten where it is wanted
  if (pass.screens_rotation) R_centre = safe_polar(centre_gradient(x, u)).R;

  EdgeLanes<V> q;
  Mat<V> Q;
  V least_det(1e300);
  set_zero(q);
  for (int k = 0; k < 9; ++k) Q.m[k / 3][k % 3] = V(0.0);
  Mat<V> gradients[kAtOnce];
  PolarLanes<V> polars[kAtOnce];
  for (int i = 0; i < kCorners; ++i) {
    if (i % kAtOnce == 0) {
      for (int m = 0; m < kAtOnce; ++m) gradients[m] = gradient(i + m);
      safe_polars<kAtOnce>(gradients, polars);
    }
    const Mat<V>& A = rest.inverse[kGeneral ? i : 0];
    const Mat<V>& F = gradients[i % kAtOnce];
    const PolarLanes<V>& FRS = polars[i % kAtOnce];
    const Sym<V> s = stress(FRS.S, mu, lambda);
    const Mat<V> P = FRS.R * matrix(s);
    for (int d = 0; d < 3; ++d)
      for (int r = 0; r < 3; ++r)
        q.at[d][kEdgeAt[i][d]][r] += P(r, 0) * A(d, 0) + P(r, 1) * A(d, 1) + P(r, 2) * A(d, 2);
    if constexpr (kGeneral)
      for (int k = 0; k < 9; ++k) Q.m[k / 3][k % 3] += P.m[k / 3][k % 3];

    store_mat(product_transposed(A, FRS.R), length, coef + 9 * i * kBlock);
    if constexpr (kGeneral) store_mat(FRS.R, V(1.0), coef + (9 * kCorners + 9 * i) * kBlock);
    store_as(stress_norm_bound(s, pass.norm), screen + (YieldScreen::kNorm + i) * kBlock);
    const Mat<V> cof = cofactor(F);
    least_det = min(least_det, F(0, 0) * cof(0, 0) + F(0, 1) * cof(0, 1) + F(0, 2) * cof(0, 2));
    if (pass.screens_rotation)
      store_as(V(0.5) * (dot(R_centre, FRS.R) - V(1.0)), screen + (YieldScreen::kCosine + i) * kBlock);
  }
  store_as(least_det, screen + YieldScreen::kMinDet * kBlock);
  store_as(rest.least_jacobian, screen + YieldScreen::kMinJacobian * kBlock);

  CornerLanes<V> f;
  if constexpr (kGeneral) {
    for (int a = 0; a < kCorners; ++a)
      for (int j = 0; j < 3; ++j) store_as(length * rest.h.at[a][j], coef + (18 * kCorners + 3 * a + j) * kBlock);
    for (int a = 0; a < kCorners; ++a)
      for (int r = 0; r < 3; ++r)
        f.at[a][r] = eighth * (Q(r, 0) * rest.h.at[a][0] + Q(r, 1) * rest.h.at[a][1] + Q(r, 2) * rest.h.at[a][2]);
    scale(eighth * share, q);
  } else {
    set_zero(f);
    blend(share, q);
    scale(eighth, q);
  }
  add_edges_transpose(q, f);
  scatter_add(f, pass.partition, block, lane, pass.force);
}

template <class T, class Coef>
void linearize_chunk(const ElementPass<T, Coef>& pass, int chunk) {
  for (int block = pass.partition.first_block[chunk]; block < pass.partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock; lane += Lanes<double>::kCount)
      if (pass.is_general[block])
        linearize_lanes<true>(pass, block, lane);
      else
        linearize_lanes<false>(pass, block, lane);
}

template <bool kGeneral>
HWY_INLINE void exact_lanes(const Model& model, const Linearization& at, int block, int lane, double factor,
                            const double* p, double* Ap) {
  using V = Lanes<double>;
  const Partition& partition = *model.partition;
  const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
  CornerLanes<V> x, u, du;
  gather(partition, block, lane, at.material.data(), x);
  gather(partition, block, lane, at.world.data(), u);
  gather(partition, block, lane, p, du);
  replace_absent(present, x);
  replace_absent(present, u);
  RestLanes<kGeneral, V> rest;
  rest_operator(x, model.settings.gradient, rest);
  const GradientLanes<kGeneral, V> gradient(rest, u), increment(rest, du);
  const double* lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  const V weight = V(factor / kCorners) * select_bits(present, rest.volume, V(0.0));
  const V mu = weight * load(lame), lambda = weight * load(lame + kBlock);

  EdgeLanes<V> q;
  Mat<V> Q;
  set_zero(q);
  for (int k = 0; k < 9; ++k) Q.m[k / 3][k % 3] = V(0.0);
  Mat<V> gradients[kAtOnce];
  PolarLanes<V> polars[kAtOnce];
  for (int i = 0; i < kCorners; ++i) {
    if (i % kAtOnce == 0) {
      for (int m = 0; m < kAtOnce; ++m) gradients[m] = gradient(i + m);
      safe_polars<kAtOnce>(gradients, polars);
    }
    const Mat<V>& A = rest.inverse[kGeneral ? i : 0];
    const Mat<V>& R = polars[i % kAtOnce].R;
    const Mat<V> P = R * stress_increment(transposed_product(R, increment(i)), mu, lambda);
    for (int d = 0; d < 3; ++d)
      for (int r = 0; r < 3; ++r)
        q.at[d][kEdgeAt[i][d]][r] += P(r, 0) * A(d, 0) + P(r, 1) * A(d, 1) + P(r, 2) * A(d, 2);
    if constexpr (kGeneral)
      for (int k = 0; k < 9; ++k) Q.m[k / 3][k % 3] += P.m[k / 3][k % 3];
  }
  set_zero(u);
  if constexpr (kGeneral) {
    for (int a = 0; a < kCorners; ++a)
      for (int r = 0; r < 3; ++r)
        u.at[a][r] = Q(r, 0) * rest.h.at[a][0] + Q(r, 1) * rest.h.at[a][1] + Q(r, 2) * rest.h.at[a][2];
    scale(rest.share, q);
  } else {
    blend(rest.share, q);
  }
  add_edges_transpose(q, u);
  scatter_add(u, partition, block, lane, Ap);
}

void exact_product(const Model& model, const Linearization& at, int chunk, double factor, const double* p, double* Ap) {
  for (int block = model.partition->first_block[chunk]; block < model.partition->first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock; lane += Lanes<double>::kCount)
      if (at.is_general[block])
        exact_lanes<true>(model, at, block, lane, factor, p, Ap);
      else
        exact_lanes<false>(model, at, block, lane, factor, p, Ap);
}

//   sum_i V/8 psi(S_i)                                                                                       eq. 18
double energy_of(const Model& model, const double* material, const double* world, std::uint16_t present, int block) {
  using V = Lanes<double>;
  V sum(0.0);
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    CornerLanes<V> x, u;
    gather(*model.partition, block, lane, material, x);
    gather(*model.partition, block, lane, world, u);
    const std::uint32_t here = static_cast<std::uint32_t>(present) >> lane;
    replace_absent(here, x);
    replace_absent(here, u);
    RestLanes<true, V> rest;
    rest_operator(x, model.settings.gradient, rest);
    const GradientLanes<true, V> gradient(rest, u);
    const double* lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
    const V mu = load(lame), lambda = load(lame + kBlock);
    V density(0.0);
    Mat<V> gradients[kAtOnce];
    PolarLanes<V> polars[kAtOnce];
    for (int first = 0; first < kCorners; first += kAtOnce) {
      for (int m = 0; m < kAtOnce; ++m) gradients[m] = gradient(first + m);
      safe_polars<kAtOnce>(gradients, polars);
      for (const PolarLanes<V>& polar : polars) density += energy_density(polar.S, mu, lambda);
    }
    sum += select_bits(here, V(1.0 / kCorners) * rest.volume * density, V(0.0));
  }
  return hn::GetLane(hn::SumOfLanes(V::Tag(), sum.raw()));
}

void linearize_coarse(const Partition& partition, const double* material, const double* world, GradientScheme gradient,
                      double length, int chunk, ElementOperator<float, float>& op) {
  using V = Lanes<double>;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      std::uint32_t present = 0;
      for (int k = 0; k < V::kCount; ++k) present |= (partition.element(block, lane + k) >= 0 ? 1u : 0u) << k;
      CornerLanes<V> x, u;
      gather(partition, block, lane, material, x);
      gather(partition, block, lane, world, u);
      RestLanes<true, V> rest;
      // corners beyond the mesh may lie anywhere: cells that they invert do not help
      for (int attempt = 0; attempt < 2; ++attempt) {
        replace_absent(present, x);
        replace_absent(present, u);
        rest_operator(x, gradient, rest);
        present &= bits<double>(rest.least_jacobian > V(0.0));
      }
      float* weight = op.weight.data() + static_cast<std::size_t>(block) * 2 * kCorners * kBlock + lane;
      for (int k = 0; k < V::kCount; ++k)
        if (!(present >> k & 1))
          for (int n = 0; n < 2 * kCorners; ++n) weight[n * kBlock + k] = 0;
      const GradientLanes<true, V> F(rest, u);
      float* coef = op.coef.data() + op.offset[block] + lane;
      Mat<V> gradients[kAtOnce];
      PolarLanes<V> polars[kAtOnce];
      for (int i = 0; i < kCorners; ++i) {
        if (i % kAtOnce == 0) {
          for (int m = 0; m < kAtOnce; ++m) gradients[m] = F(i + m);
          safe_polars<kAtOnce>(gradients, polars);
        }
        const Mat<V>& R = polars[i % kAtOnce].R;
        store_mat(product_transposed(rest.inverse[i], R), V(length), coef + 9 * i * kBlock);
        store_mat(R, V(1.0), coef + (9 * kCorners + 9 * i) * kBlock);
      }
      for (int k = 0; k < 3 * kCorners; ++k)
        store_as(V(length) * rest.h.at[k / 3][k % 3], coef + (18 * kCorners + k) * kBlock);
    }
}

/// A hexahedron is a parallelepiped when the edges of each direction agree to `alike` of the longest one.
void find_general(const Partition& partition, const double* material, const std::uint16_t* present, double alike,
                  int chunk, unsigned char* is_general) {
  using V = Lanes<double>;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    is_general[block] = 0;
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      CornerLanes<V> x;
      EdgeLanes<V> e;
      gather(partition, block, lane, material, x);
      replace_absent(static_cast<std::uint32_t>(present[block]) >> lane, x);
      edges(x, e);
      V longest(0.0), difference(0.0);
      for (int k = 0; k < 9; ++k) {
        const V* edge[4];
        for (int m = 0; m < 4; ++m) edge[m] = &e.at[k / 3][m][k % 3];
        longest = max(longest, abs(*edge[0]));
        for (int m = 1; m < 4; ++m) difference = max(difference, abs(*edge[m] - *edge[0]));
      }
      is_general[block] |= bits<double>(difference > V(alike) * longest) != 0;
    }
  }
}

void linearize_double(const ElementPass<double, double>& pass, int chunk) { linearize_chunk(pass, chunk); }
void linearize_float(const ElementPass<float, float>& pass, int chunk) { linearize_chunk(pass, chunk); }
void linearize_half(const ElementPass<float, Half>& pass, int chunk) { linearize_chunk(pass, chunk); }

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(linearize_double);
HWY_EXPORT(linearize_float);
HWY_EXPORT(linearize_half);
HWY_EXPORT(find_general);
HWY_EXPORT(linearize_coarse);
HWY_EXPORT(exact_product);
HWY_EXPORT(energy_of);

template <>
void linearize_elements(const ElementPass<double, double>& pass, int chunk) {
  HWY_DYNAMIC_DISPATCH(linearize_double)(pass, chunk);
}
template <>
void linearize_elements(const ElementPass<float, float>& pass, int chunk) {
  HWY_DYNAMIC_DISPATCH(linearize_float)(pass, chunk);
}
template <>
void linearize_elements(const ElementPass<float, Half>& pass, int chunk) {
  HWY_DYNAMIC_DISPATCH(linearize_half)(pass, chunk);
}

void add_exact_product(const Model& model, const Linearization& at, int chunk, double factor, const double* p,
                       double* Ap) {
  HWY_DYNAMIC_DISPATCH(exact_product)(model, at, chunk, factor, p, Ap);
}
double block_energy(const Model& model, const double* material, const double* world, std::uint16_t present, int block) {
  return HWY_DYNAMIC_DISPATCH(energy_of)(model, material, world, present, block);
}
void linearize_cells(const Partition& partition, const double* material, const double* world, GradientScheme gradient,
                     double length, int chunk, ElementOperator<float, float>& op) {
  HWY_DYNAMIC_DISPATCH(linearize_coarse)(partition, material, world, gradient, length, chunk, op);
}
void find_general_blocks(const Partition& partition, const double* material, const std::uint16_t* present, double alike,
                         int chunk, unsigned char* is_general) {
  HWY_DYNAMIC_DISPATCH(find_general)(partition, material, present, alike, chunk, is_general);
}

}  // namespace hexaplast
#endif
