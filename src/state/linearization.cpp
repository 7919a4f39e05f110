// SPDX-License-Identifier: LGPL-2.1-or-later
#include "state/linearization.hpp"

#include <algorithm>

#include "base/simd.hpp"

namespace hexaplast {

namespace {

std::size_t per_element(const Model& model) { return static_cast<std::size_t>(model.partition->num_blocks) * kBlock; }

decltype(Linearization::op) operator_of(const Model& model) {
  if (model.settings.precision == Precision::kDouble) return ElementOperator<double, double>(model.partition);
  if (simd_has_half() && std::ranges::count(model.is_thin(), 0) == model.mesh.num_elements())
    return ElementOperator<float, Half>(model.partition);
  return ElementOperator<float, float>(model.partition);
}

}  // namespace

template <class T, class Coef>
ElementOperator<T, Coef>::ElementOperator(std::shared_ptr<const Partition> partition)
    : is_general(partition->num_blocks), partition_(std::move(partition)) {}

template <class T, class Coef>
void ElementOperator<T, Coef>::resize(const std::vector<unsigned char>& kinds, const unsigned char* has_coefficients) {
  const auto count = [&](bool general) {
    if (kind.one_rotation) return StoredOneRotation<Coef>::kCount;
    return general ? StoredElement<true, Coef>::count(kind.has_law())
                   : StoredElement<false, Coef>::count(kind.has_law());
  };
  is_general = kinds;
  first_.assign(1, 0);
  for (std::size_t block = 0; block < kinds.size(); ++block) {
    const bool has_some = !has_coefficients || has_coefficients[block];
    first_.push_back(first_.back() + (has_some ? kBlock * count(kinds[block] != 0) : 0));
  }
  coef_.resize(first_.back());
  weight_.resize(kinds.size() * 2 * kBlock);
}

template class ElementOperator<double, double>;
template class ElementOperator<float, Half>;
template class ElementOperator<float, float>;

Linearization::Linearization(const Model& model)
    : plastic_rest(slot_vector<double>(*model.partition)),
      present(model.partition->num_blocks),
      is_general(model.partition->num_blocks),
      volume(per_element(model)),
      has_flowed(model.settings.rest_shape == RestShape::kIsolated ? model.partition->num_blocks : 0),
      least_yield(model.partition->num_blocks),
      mean_plastic(has_flowed.size() * kMeanPlastic * kBlock),
      is_stale(model.partition->num_chunks, 1),
      current(slot_vector<double>(*model.partition)),
      of_chunks(slot_vector<double>(*model.partition)),
      force(slot_vector<double>(*model.partition)),
      screen(per_element(model) * YieldScreen::kQuantities),
      thin(model.partition->num_blocks),
      op(operator_of(model)) {}

}  // namespace hexaplast
