// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once per instruction set; the functions at the end choose at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "elastic/cycle_operator.cpp"
#include "hwy/foreach_target.h"
//
#include <algorithm>

#include "elastic/cycle_operator.hpp"
#include "elastic/one_rotation-inl.hpp"
#include "hexaplast/base/parallel.hpp"
#include "layout/corners-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace hexaplast::HWY_NAMESPACE {

HEXAPLAST_INLINE Mat<Lanes<float>> load_mean_plastic(const float* from) {
  using V = Lanes<float>;
  Mat<V> Gm;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) Gm(r, c) = c > r ? V(0.0f) : load(from + of_mean_plastic(r, c) * kBlock);
  return Gm;
}

/// Coefficients with one rotation, as if elements were parallelepipeds, of the blocks of a chunk whose entry in
/// `blocks` is not 0. `op` is of that kind. In single precision: they are stored in half.
void linearize_as_simple(const Model& model, const Linearization& at, const unsigned char* blocks, int chunk,
                         ElementOperator<float, Half>& op) {
  using V = Lanes<float>;
  const Partition& partition = *model.partition;
  const V length(static_cast<float>(model.length));
  for (int block = partition.first_block[chunk]; block < partition.first_block[chunk + 1]; ++block)
    for (int lane = 0; lane < kBlock && blocks[block]; lane += V::kCount) {
      const std::uint32_t present = static_cast<std::uint32_t>(at.present[block]) >> lane;
      CornerLanes<V> x, u;
      gather_about_corner<float>(partition, block, lane, at.plastic_rest.data(), x);
      gather_about_corner<float>(partition, block, lane, at.current.data(), u);
      replace_absent(present, x);
      replace_absent(present, u);
      ElementLanes<false, V> element;
      const float* const stored_mean = at.mean_plastic_of(block);
      Mat<V> mean_plastic;
      if (stored_mean) mean_plastic = load_mean_plastic(stored_mean + lane);
      place_mean(x, u, op.kind.sampling, stored_mean ? &mean_plastic : nullptr, element);
      ModeLanes<V> current, of_volume;
      modes(u, current);
      volume_of(current, of_volume);
      const double* const lame = model.lame_blocks.data() + static_cast<std::size_t>(block) * 2 * kBlock + lane;
      const V mu = load_narrow<float>(lame), lambda = load_narrow<float>(lame + kBlock);
      store_weights(op, load_narrow<float>(at.volume.data() + static_cast<std::size_t>(block) * kBlock + lane),
                    model.length, mu, lambda, block, lane);
      const Mat<V> j = scaled(length, element.j);
      const ElementModuli<V> of(op.kind, false, mu, lambda);
      ModeStiffness<V> stiffness(j, op.kind.sampling.corner_weight, of.mu, of.free);
      store_one_rotation(element.rest, j, stiffness, of_volume, length,
                         StoredOneRotation(coefficients(op, block, lane)));
    }
}

}  // namespace hexaplast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hexaplast {

HWY_EXPORT(linearize_as_simple);

namespace {

constexpr double kMinCorner = 0.5;  // of the volume over 8, that a corner's Jacobian of a simple element has

/// Whether each element of a block is nearly a parallelepiped.
bool is_well_shaped(const Linearization& at, int block) {
  const float* min = at.screen.data() +
                     (static_cast<std::size_t>(block) * YieldScreen::kQuantities + YieldScreen::kMinJacobian) * kBlock;
  const double* volume = at.volume.data() + static_cast<std::size_t>(block) * kBlock;
  for (int place = 0; place < kBlock; ++place)
    if ((at.present[block] >> place & 1) && !(kCorners * min[place] > kMinCorner * volume[place])) return false;
  return true;
}

}  // namespace

CycleOperator::CycleOperator(const Model& model)
    : simple_(model.partition),
      rounded_(model.partition),
      is_simple_(model.partition->num_blocks),
      keeps_its_own_(model.partition->num_blocks),
      is_thin_(model.partition->num_blocks) {
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    if (model.is_thin()[e]) is_thin_[model.partition->place_of_element[e] / kBlock] = 1;
  simple_.kind = {.sampling = {.assumes_strain = true, .corner_weight = sampling_of(model.settings).corner_weight},
                  .one_rotation = true};
  simple_.resize(std::vector<unsigned char>(model.partition->num_blocks, 0));
}

template <class Visit>
void CycleOperator::visit_others(const Visit& visit) const {
  std::visit(
      [&]<class T, class Coef>(const ElementOperator<T, Coef>& op) {
        if constexpr (std::is_same_v<T, double>)
          visit(rounded_);
        else
          visit(op);
      },
      at_->op);
}

void CycleOperator::update(const Model& model, const Linearization& at) {
  set_linearization(at);
  simple_.kind.branches = at.kind().branches;
  const Partition& partition = *model.partition;
  parallel_for(partition.num_blocks, [&](int block) {
    is_simple_[block] = !is_thin_[block] && is_well_shaped(at, block);
    keeps_its_own_[block] = !is_simple_[block];
  });
  parallel_for(partition.num_chunks, [&](int chunk) {
    HWY_DYNAMIC_DISPATCH(linearize_as_simple)(model, at, is_simple_.data(), chunk, simple_);
  });

  const auto* wide = std::get_if<ElementOperator<double, double>>(&at.op);
  if (!wide) return;
  rounded_.kind = wide->kind;
  rounded_.resize(wide->is_general, keeps_its_own_.data());
  parallel_for(partition.num_blocks, [&](int block) {
    if (!keeps_its_own_[block]) return;
    const auto round = [](double number) { return static_cast<float>(number); };
    const auto weights = wide->weights(block, 0);
    std::ranges::transform(wide->coefficients(block), rounded_.coefficients(block).begin(), round);
    std::transform(weights[0], weights[2], rounded_.weights(block, 0)[0], round);
  });
}

void CycleOperator::add_product(int chunk, float factor, const float* p, float* Ap) const {
  simple_.add_product_of(is_simple_.data(), chunk, factor, p, Ap);
  visit_others([&](const auto& op) { op.add_product_of(keeps_its_own_.data(), chunk, factor, p, Ap); });
}

void CycleOperator::add_diagonal(int chunk, float factor, float* diagonal) const {
  simple_.add_diagonal_of(is_simple_.data(), chunk, factor, diagonal);
  visit_others([&](const auto& op) { op.add_diagonal_of(keeps_its_own_.data(), chunk, factor, diagonal); });
}

}  // namespace hexaplast
#endif
