// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/linearize_pass.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/body_elements-inl.hpp"
#include "elastic/element_kernels-inl.hpp"
#include "elastic/linearize_pass.hpp"
#include "material/law-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Gm, a lower triangle, of a register of elements.
HEXAPLAST_INLINE void store_mean_plastic(const Mat<Lanes<double>>& Gm, float* to) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) store_as(Gm(r, c), to + of_mean_plastic(r, c) * kBlock);
}

/// Of the volume ratio.                                                                                        eq. E6
template <class V>
HEXAPLAST_INLINE void add_volume_force(const MaterialLanes<V>& of, const PressureLanes<V>& p,
                                       const ModeLanes<V>& of_volume, V corner_weight, CornerLanes<V>& f) {
  const V pressure = of.of_volume() * p.excess * corner_weight;
  CornerLanes<V> gradient;
  modes_transpose(of_volume, gradient);
  for (int a = 0; a < kCorners; ++a)
    for (int i = 0; i < 3; ++i) f.at[a][i] -= pressure * gradient.at[a][i];
}

/// - dE/du, of what acts on the samples.                                                    eq. 15, E6, E12, E13, E15
template <bool kGeneral, class V>
HEXAPLAST_NOINLINE void finish_force(const ElementLanes<kGeneral, V>& element, const MaterialLanes<V>& of,
                                     const PressureLanes<V>& p, const ModeLanes<V>& of_volume, V volume,
                                     ColumnsTranspose<kGeneral, V>& acting, CornerLanes<V>& f) {
  const auto& rest = element.rest;
  const V eighth = V(-1.0 / kCorners) * volume;
  acting.take_assumed(rest, AssumedLanes<V>(element.j, rest.corner_weight));
  // samples with rotations of their own feel that of the mean by what is assumed alone
  V moment[3] = {V(0.0), V(0.0), V(0.0)};
  add_moment(1, element.columns.a, acting.a, moment);
  add_moment(-1, element.columns.Q, acting.Q, moment);
  const Mat<V> turns = turning(element.mean, element.j, moment);
  acting.finish(rest, &turns, eighth, f);
  add_volume_force(of, p, of_volume, volume / rest.volume, f);  // 0 where nothing is
}

/// What branches add to what acts on the samples.                                                        eq. P14, P15
template <bool kGeneral, class V>
HEXAPLAST_NOINLINE void add_branch_force(const ElementLanes<kGeneral, V>& element, const BranchLanes<V>& branches,
                                         ColumnsTranspose<kGeneral, V>& acting) {
  Sym<V> D[kCorners];
  branches.changes([&](int i) { return element.polar[i].S; }, D);
  for (int i = 0; i < kCorners; ++i) {
    const PolarLanes<V>& at = element.polar[i];
    const Mat<V> P = at.R * balanced_stress(branches.stress(i, D[i]), at);
    acting.add_to_columns(i, product_transposed(inverse_at(element, i), P));
    if constexpr (kGeneral)
      acting.add_shared(i, element.plastic ? product_transposed(P, element.plastic->inverse[i]) : P);
  }
}

/// Whether no corner can be thin: where the gradient of a corner F_i is nearer than 1 - ratio^1/3 to a rotation, det
/// F_i is above the ratio. Of parallelepipeds that have not flowed, with Q the hourglass modes,                   eq.
/// E31
///
///   |F_i - R_m|^2 <= 2 |S_m - I|^2 + 2 |F_i - F_m|^2 <= 2 |S_m - I|^2 + 18 |Q|^2 |J_o^-1 / 2|^2
template <bool kGeneral, class V>
HEXAPLAST_NOINLINE bool corners_are_thick(const ElementLanes<kGeneral, V>& element, double safe_strain) {
  if constexpr (kGeneral) {
    return false;
  } else {
    if (element.plastic) return false;
    const Sym<V>& S = element.mean.S;
    const V one(1.0);
    const V strain = squared_norm(Sym<V>{S.xx - one, S.yy - one, S.zz - one, S.yz, S.zx, S.xy});
    V modes(0.0), dual(0.0);
    for (const auto& mode : element.columns.Q) modes += dot(mode, mode);
    for (const auto& row : dual_of(element.rest).m) dual += dot(row, row);
    const V bound = strain + V(9.0) * modes * dual;
    return bits<double>(bound < V(0.5 * safe_strain * safe_strain)) == (1u << V::kCount) - 1;
  }
}

/// The stress that yields of isolated rest shapes, or more. In each of three directions, what is relieved at a sample
/// is at most the mean of |sigma_j|: where that does not reach least_yield, nothing is relieved.                 eq. P8
template <bool kGeneral, class V>
HEXAPLAST_NOINLINE void screen_isolated(const ElementLanes<kGeneral, V>& element, const MaterialLanes<V>& of,
                                        const PressureLanes<V>& p, const Settings& settings, double least_yield,
                                        float* screen) {
  Sym<V> corotated[kCorners], sigma[kCorners];
  yielding_stress(element, of, p, settings.yield_stress_measure, nullptr, corotated, sigma);
  V norm[kCorners], largest(0.0), sum(0.0);
  for (int i = 0; i < kCorners; ++i) {
    norm[i] = stress_norm_bound(sigma[i], settings.yield_norm);
    largest = max(largest, norm[i]);
    sum += sqrt(squared_norm(sigma[i]));
  }
  const V relieved = V(3.0 / kCorners) * sum;
  if (bits<double>(largest + relieved < V(least_yield)) == (1u << V::kCount) - 1) {
    for (V& one : norm) one += relieved;
  } else {
    Mat<V> normals[kCorners];
    sample_normals(element, normals);
    relieve(normals, sigma);
    for (int i = 0; i < kCorners; ++i) norm[i] = stress_norm_bound(sigma[i], settings.yield_norm);
  }
  for (int i = 0; i < kCorners; ++i) store_as(norm[i], screen + (YieldScreen::kNorm + i) * kBlock);
}

template <bool kGeneral, class T, class Coef>
HEXAPLAST_NOINLINE void linearize_lanes(const LinearizePass& pass, ElementOperator<T, Coef>& op, int block, int lane) {
  using V = Lanes<double>;
  const Model& model = pass.model;
  const Partition& partition = *model.partition;
  Linearization& at = pass.at;
  const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
  CornerLanes<V> x, u;
  ModeLanes<V> of_volume;
  gather_shapes(partition, block, lane, present, at.plastic_rest.data(), at.current.data(), x, u);
  PlasticLanes<V> plastic;
  ElementLanes<kGeneral, V> element;
  place_element(x, u, op.kind.sampling,
                load_plastic(partition, at.flowed_at(pass.history, block), block, lane, plastic), element);
  decompose(element);
  const V volume = select_bits(present, element.rest.volume, V(0.0));
  store(volume, at.volume.data() + static_cast<std::size_t>(block) * kBlock + lane);
  const MaterialLanes<V> of = material_lanes<double>(model.settings, model.lame_blocks, block, lane);
  store_weights(op, volume, model.length, of.mu, of.lambda, block, lane);
  const PressureLanes<V> p = pressures(of, element, u, of_volume);
  CoefficientWriter<kBlock, kGeneral, V, typename Stored<Coef>::type> writer(element, op.kind, V(model.length),
                                                                             coefficients(op, block, lane));

  float* const screen = at.screen.data() + static_cast<std::size_t>(block) * YieldScreen::kQuantities * kBlock + lane;
  V min_det(1e300);
  ColumnsTranspose<kGeneral, V> acting;
  for (int i = 0; i < kCorners; ++i) {
    const auto& [R, S, doubtful] = element.polar[i];
    const V theta = dilatation(of.law, S);
    const Sym<V> sigma = stress(of.law, of.mooney_fraction, S, of.mu, p.at(theta));
    const Mat<V> P = R * matrix(sigma);
    acting.add_columns(i, product_transposed(inverse_at(element, i), P));
    if constexpr (kGeneral)  //                                                                                 eq. P4
      acting.add_shared(i, element.plastic ? product_transposed(P, element.plastic->inverse[i]) : P);
    writer.add_sample(i, of, p);

    const Mat<V>& F = element.F[i];
    const Mat<V> cof = cofactor(F);
    min_det = min(min_det, F(0, 0) * cof(0, 0) + F(0, 1) * cof(0, 1) + F(0, 2) * cof(0, 2));
  }
  store_as(min_det, screen + YieldScreen::kMinDet * kBlock);
  store_as(element.rest.min_jacobian, screen + YieldScreen::kMinJacobian * kBlock);
  if (std::isfinite(pass.thin_from) && !corners_are_thick(element, pass.safe_strain))
    at.thin[block] |= find_thin<kGeneral>(x, u, element.rest.volume, pass.thin_from) << lane;
  if (pass.screens) screen_isolated(element, of, p, model.settings, at.least_yield[block], screen);
  if (element.plastic)
    store_mean_plastic(plastic.mean,
                       at.mean_plastic.data() + static_cast<std::size_t>(block) * kMeanPlastic * kBlock + lane);
  BranchLanes<V> lanes;
  if (const BranchLanes<V>* branches = load_branches(partition, pass.branches, block, lane, of.mu, of.lambda, lanes))
    add_branch_force(element, *branches, acting);
  writer.finish(of_volume);

  CornerLanes<V> f;
  finish_force(element, of, p, of_volume, volume, acting, f);
  scatter_add(f, partition, block, lane, at.of_chunks.data());
}

void linearize(const LinearizePass& pass, int chunk) {
  const Partition& partition = *pass.model.partition;
  std::visit(
      [&](auto& op) {
        for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
          pass.at.thin[block] = 0;
          for (int lane = 0; lane < kBlock; lane += Lanes<double>::kCount)
            for_shape(
                pass.at.is_general[block] != 0, [&]<bool kGeneral>() __attribute__((always_inline)) {
                  linearize_lanes<kGeneral>(pass, op, block, lane);
                });
        }
      },
      pass.at.op);
}

/// A hexahedron is a parallelepiped when the edges of each direction agree to `alike` of the longest one.
void find_general(const Partition& partition, const double* plastic_rest, const std::uint16_t* present, double alike,
                  int chunk, unsigned char* is_general) {
  using V = Lanes<double>;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block) {
    is_general[block] = 0;
    for (int lane = 0; lane < kBlock; lane += V::kCount) {
      CornerLanes<V> x;
      EdgeLanes<V> e;
      gather(partition, block, lane, plastic_rest, x);
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

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(linearize);
HWY_EXPORT(find_general);

void linearize_elements(const LinearizePass& pass, int chunk) { HWY_DYNAMIC_DISPATCH(linearize)(pass, chunk); }
void find_general_blocks(const Partition& partition, const double* plastic_rest, const std::uint16_t* present,
                         double alike, int chunk, unsigned char* is_general) {
  HWY_DYNAMIC_DISPATCH(find_general)(partition, plastic_rest, present, alike, chunk, is_general);
}

}  // namespace hexaplast
#endif
