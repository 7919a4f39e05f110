// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/element_pass.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/element_kernels-inl.hpp"
#include "elastic/element_pass.hpp"
#include "element/lane_elements-inl.hpp"
#include "material/stress_norm-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

/// Gm, a lower triangle, of a register of elements.
HEXAPLAST_INLINE void store_mean_plastic(const Mat<Lanes<double>>& Gm, float* to) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) store_as(Gm(r, c), to + of_mean_plastic(r, c) * kBlock);
}
HEXAPLAST_INLINE Mat<Lanes<double>> load_mean_plastic(const float* from) {
  using V = Lanes<double>;
  Mat<V> Gm;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) Gm(r, c) = c > r ? V(0.0) : load_wide(from + of_mean_plastic(r, c) * kBlock);
  return Gm;
}

/// The G of a register of elements, of those of all elements, into `plastic`; null: nothing has flowed.
HEXAPLAST_NOINLINE const PlasticLanes<Lanes<double>>* load_plastic(const Partition& partition,
                                                                   const CornerTensors* plastic_inverse, int block,
                                                                   int lane, PlasticLanes<Lanes<double>>& plastic) {
  if (!plastic_inverse) return nullptr;
  using V = Lanes<double>;
  const LaneElements<V> elements(partition, block, lane);
  V numbers[9 * kCorners];
  load_elements<9 * kCorners>(
      addresses<const double>(elements.number, [&](int e) { return plastic_inverse[e][0].data(); }), numbers);
  set_plastic_inverse([&](int n) { return numbers[n]; }, plastic);
  return &plastic;
}

/// Loads an element per lane; those that are not there become unit cubes.
template <class V>
HEXAPLAST_INLINE void gather_shapes(const Partition& partition, int block, int lane, std::uint32_t present,
                                    const double* plastic_rest, const double* current, CornerLanes<V>& x,
                                    CornerLanes<V>& u) {
  gather(partition, block, lane, plastic_rest, x);
  gather(partition, block, lane, current, u);
  replace_absent(present, x);
  replace_absent(present, u);
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

/// Stores volume [m^3] and weights of elements, and says what they are made of.
template <class V, class T, class Coef>
HEXAPLAST_INLINE MaterialLanes<V> begin_elements(const ElementPass<T, Coef>& pass, int block, int lane, V volume) {
  store(volume, pass.volume + static_cast<std::size_t>(block) * kBlock + lane);
  const double* lame = pass.lame + static_cast<std::size_t>(block) * 2 * kBlock + lane;
  const MaterialLanes<V> of(pass.settings, load(lame), load(lame + kBlock));
  const auto weight = pass.op.weights(block, lane);
  const V per_sample = V(1 / (kCorners * pass.length * pass.length)) * volume;
  store_as(per_sample * of.mu, weight[0]);
  store_as(per_sample * of.lambda, weight[1]);
  return of;
}
template <class T, class Coef>
HEXAPLAST_INLINE float* screen_of(const ElementPass<T, Coef>& pass, int block, int lane) {
  return pass.screen + static_cast<std::size_t>(block) * YieldScreen::kQuantities * kBlock + lane;
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
HEXAPLAST_NOINLINE void linearize_lanes(const ElementPass<T, Coef>& pass, int block, int lane) {
  using V = Lanes<double>;
  const std::uint32_t present = static_cast<std::uint32_t>(pass.present[block]) >> lane;
  const StiffnessKind& kind = pass.op.kind;
  CornerLanes<V> x, u;
  ModeLanes<V> of_volume;
  gather_shapes(pass.partition, block, lane, present, pass.plastic_rest, pass.current, x, u);
  PlasticLanes<V> plastic;
  ElementLanes<kGeneral, V> element;
  place_element(x, u, kind.sampling, load_plastic(pass.partition, pass.flowed_at(block), block, lane, plastic),
                element);
  decompose(element);
  const V volume = select_bits(present, element.rest.volume, V(0.0));
  const MaterialLanes<V> of = begin_elements(pass, block, lane, volume);
  const PressureLanes<V> p = pressures(of, element, u, of_volume);
  CoefficientWriter<kBlock, kGeneral, V, typename Stored<Coef>::type> writer(element, kind, V(pass.length),
                                                                             coefficients(pass.op, block, lane));

  float* const screen = screen_of(pass, block, lane);
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
    pass.thin[block] |= find_thin<kGeneral>(x, u, element.rest.volume, pass.thin_from) << lane;
  if (pass.screens) screen_isolated(element, of, p, pass.settings, pass.least_yield[block], screen);
  if (element.plastic) store_mean_plastic(plastic.mean, pass.mean_plastic_of(block) + lane);
  BranchLanes<V> lanes;
  if (const BranchLanes<V>* branches =
          load_branches(pass.partition, pass.branches, block, lane, of.mu, of.lambda, lanes))
    add_branch_force(element, *branches, acting);
  writer.finish(of_volume);

  CornerLanes<V> f;
  finish_force(element, of, p, of_volume, volume, acting, f);
  scatter_add(f, pass.partition, block, lane, pass.force);
}

template <class T, class Coef>
void linearize_chunk(const ElementPass<T, Coef>& pass, int chunk) {
  for (int block = pass.partition.first_block[chunk]; block < pass.partition.first_block[chunk + 1]; ++block) {
    pass.thin[block] = 0;
    for (int lane = 0; lane < kBlock; lane += Lanes<double>::kCount)
      for_shape(
          pass.op.is_general[block] != 0, [&]<bool kGeneral>() __attribute__((always_inline)) {
            linearize_lanes<kGeneral>(pass, block, lane);
          });
  }
}

/// The coefficients of one register of elements in double precision, computed anew.
template <bool kGeneral>
struct ExactCoefficients {
  using V = Lanes<double>;
  static constexpr int kStride = V::kCount;
  using Element = StoredElement<kGeneral, const double, kStride>;

  HEXAPLAST_NOINLINE ExactCoefficients(const Model& model, const History& history, const Linearization& at, int block,
                                       int lane, double factor)
      : kind(at.kind()) {
    const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
    CornerLanes<V> x, u;
    ModeLanes<V> of_volume;
    gather_shapes(*model.partition, block, lane, present, at.plastic_rest.data(), at.current.data(), x, u);
    ElementLanes<kGeneral, V> element;
    const double* lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
    const MaterialLanes<V> of(model.settings, load(lame), load(lame + kBlock));
    PlasticLanes<V> plastic;
    place_element(x, u, kind.sampling,
                  load_plastic(*model.partition, at.flowed_at(history, block), block, lane, plastic), element);
    decompose(element);
    const PressureLanes<V> p = pressures(of, element, u, of_volume);
    CoefficientWriter<kStride, kGeneral, V, double> writer(element, kind, V(1.0), coef);
    for (int i = 0; i < kCorners; ++i) writer.add_sample(i, of, p);
    writer.finish(of_volume);
    const V per_sample = V(factor / kCorners) * select_bits(present, element.rest.volume, V(0.0));
    store(per_sample * of.mu, weight);
    store(per_sample * of.lambda, weight + kStride);
  }
  HEXAPLAST_NOINLINE void apply(CornerLanes<V>& u) const {
    const StoredNumbers<2, kStride, const double> weights{weight};
    if (kind.has_law())
      apply_stiffness<true>(Element(coef), kind, weights, V(1.0), u);
    else
      apply_stiffness<false>(Element(coef), kind, weights, V(1.0), u);
  }

  StiffnessKind kind;
  alignas(64) double coef[Element::count(true) * kStride];
  alignas(64) double weight[2 * kStride];
};

void exact_product(const Model& model, const History& history, const Linearization& at, int chunk, double factor,
                   const double* p, double* Ap) {
  const Partition& partition = *model.partition;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock; lane += Lanes<double>::kCount)
      for_shape(
          at.is_general[block] != 0, [&]<bool kGeneral>() __attribute__((always_inline)) {
            const ExactCoefficients<kGeneral> of(model, history, at, block, lane, factor);
            CornerLanes<Lanes<double>> u;
            gather(partition, block, lane, p, u);
            of.apply(u);
            scatter_add(u, partition, block, lane, Ap);
          });
}

/// Column by column, the products with unit vectors.
void matrices_of(const Model& model, const History& history, const Linearization& at, int block, double factor,
                 ElementMatrix* matrices) {
  using V = Lanes<double>;
  for (int lane = 0; lane < kBlock; lane += V::kCount)
    for_shape(
        at.is_general[block] != 0, [&]<bool kGeneral>() __attribute__((always_inline)) {
          const ExactCoefficients<kGeneral> of(model, history, at, block, lane, factor);
          for (int column = 0; column < 3 * kCorners; ++column) {
            CornerLanes<V> u;
            set_zero(u);
            u.at[column / 3][column % 3] = V(1.0);
            of.apply(u);
            alignas(64) double entries[V::kCount];
            for (int row = 0; row < 3 * kCorners; ++row) {
              store(u.at[row / 3][row % 3], entries);
              for (int k = 0; k < V::kCount; ++k) matrices[lane + k](row, column) = entries[k];
            }
          }
        });
}

/// Elastic energy.                                                                              eq. 18, E5, E14, P17
double energy_of(const Model& model, const CornerTensors* plastic_inverse, const Branches& branches,
                 const double* plastic_rest, const double* current, std::uint16_t present, int block,
                 std::uint16_t* thin) {
  using V = Lanes<double>;
  V sum(0.0);
  *thin = 0;
  for (int lane = 0; lane < kBlock; lane += V::kCount) {
    const std::uint32_t here = static_cast<std::uint32_t>(present) >> lane;
    CornerLanes<V> x, u;
    ModeLanes<V> gradient;
    gather_shapes(*model.partition, block, lane, here, plastic_rest, current, x, u);
    const double* lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
    const MaterialLanes<V> of(model.settings, load(lame), load(lame + kBlock));
    PlasticLanes<V> of_lanes;
    const PlasticLanes<V>* const plastic = load_plastic(*model.partition, plastic_inverse, block, lane, of_lanes);
    if (const double from = Recovery::from(model.settings); std::isfinite(from))
      *thin |= find_thin<true>(x, u, V(0.0), from) << lane;
    ElementLanes<true, V> element;
    place_element(x, u, sampling_of(model.settings), plastic, element);
    decompose(element);
    V density = mean_energy_density(of, element, pressures(of, element, u, gradient));
    BranchLanes<V> lanes;
    if (const BranchLanes<V>* held = load_branches(*model.partition, branches, block, lane, of.mu, of.lambda, lanes)) {
      Sym<V> D[kCorners];
      held->changes([&](int i) { return element.polar[i].S; }, D);
      for (int i = 0; i < kCorners; ++i) density += V(1.0 / kCorners) * held->energy(i, D[i]);
    }
    sum += select_bits(here, element.rest.volume * density, V(0.0));
  }
  return hn::GetLane(hn::SumOfLanes(V::Tag(), sum.raw()));
}

void linearize_as_simple(const Model& model, const Linearization& at, const unsigned char* blocks, int chunk,
                         ElementOperator<float, Half>& op) {
  using V = Lanes<double>;
  const Partition& partition = *model.partition;
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock && blocks[block]; lane += V::kCount) {
      const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
      CornerLanes<V> x, u;
      gather_shapes(partition, block, lane, present, at.plastic_rest.data(), at.current.data(), x, u);
      ElementLanes<false, V> element;
      const float* const stored_mean = at.mean_plastic_of(block);
      Mat<V> mean_plastic;
      if (stored_mean) mean_plastic = load_mean_plastic(stored_mean + lane);
      place_mean(x, u, op.kind.sampling, stored_mean ? &mean_plastic : nullptr, element);
      ModeLanes<V> current, of_volume;
      modes(u, current);
      volume_of(current, of_volume);
      const double* lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
      const V mu = load(lame), lambda = load(lame + kBlock);
      const V per_sample = V(1 / (kCorners * model.length * model.length)) *
                           load(at.volume.data() + static_cast<std::size_t>(block) * kBlock + lane);
      const auto weight = op.weights(block, lane);
      store_as(per_sample * mu, weight[0]);
      store_as(per_sample * lambda, weight[1]);
      const Mat<V> j = scaled(V(model.length), element.j);
      const ElementModuli<V> of(op.kind, false, mu, lambda);
      ModeStiffness<V> stiffness(j, op.kind.sampling.corner_weight, of.mu, of.free);
      store_one_rotation(element.rest, j, stiffness, of_volume, V(model.length),
                         StoredOneRotation(coefficients(op, block, lane)));
    }
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
HWY_EXPORT(linearize_as_simple);
HWY_EXPORT(exact_product);
HWY_EXPORT(energy_of);
HWY_EXPORT(matrices_of);

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

void add_exact_product(const Model& model, const History& history, const Linearization& at, int chunk, double factor,
                       const double* p, double* Ap) {
  HWY_DYNAMIC_DISPATCH(exact_product)(model, history, at, chunk, factor, p, Ap);
}
double block_energy(const Model& model, const CornerTensors* plastic_inverse, const Branches& branches,
                    const double* plastic_rest, const double* current, std::uint16_t present, int block,
                    std::uint16_t* thin) {
  return HWY_DYNAMIC_DISPATCH(energy_of)(model, plastic_inverse, branches, plastic_rest, current, present, block, thin);
}
void element_matrices(const Model& model, const History& history, const Linearization& at, int block, double factor,
                      ElementMatrix* matrices) {
  HWY_DYNAMIC_DISPATCH(matrices_of)(model, history, at, block, factor, matrices);
}
void linearize_simple(const Model& model, const Linearization& at, const unsigned char* blocks, int chunk,
                      ElementOperator<float, Half>& op) {
  HWY_DYNAMIC_DISPATCH(linearize_as_simple)(model, at, blocks, chunk, op);
}
void find_general_blocks(const Partition& partition, const double* plastic_rest, const std::uint16_t* present,
                         double alike, int chunk, unsigned char* is_general) {
  HWY_DYNAMIC_DISPATCH(find_general)(partition, plastic_rest, present, alike, chunk, is_general);
}

}  // namespace hexaplast
#endif
