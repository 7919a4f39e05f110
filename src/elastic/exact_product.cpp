// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/exact_product.cpp"
#include "hwy/foreach_target.h"
//
#include "elastic/body_elements-inl.hpp"
#include "elastic/element_kernels-inl.hpp"
#include "elastic/exact_product.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

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
    const MaterialLanes<V> of = material_lanes<double>(model.settings, model.lame_blocks, block, lane);
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

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(exact_product);
HWY_EXPORT(matrices_of);

void DoublePrecisionOperator::add_product(int chunk, double factor, const double* p, double* Ap) const {
  HWY_DYNAMIC_DISPATCH(exact_product)(*model_, *history_, *at_, chunk, factor, p, Ap);
}
void element_matrices(const Model& model, const History& history, const Linearization& at, int block, double factor,
                      ElementMatrix* matrices) {
  HWY_DYNAMIC_DISPATCH(matrices_of)(model, history, at, block, factor, matrices);
}

}  // namespace hexaplast
#endif
