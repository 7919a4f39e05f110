// SPDX-License-Identifier: LGPL-2.1-or-later
#include "state/linearization.hpp"

#include "hexaplast/base/simd.hpp"

namespace hexaplast {

namespace {

std::size_t per_element(const Model& model) { return static_cast<std::size_t>(model.partition->num_blocks) * kBlock; }

decltype(Linearization::op) operator_of(const Model& model) {
  if (model.settings.precision == Precision::kDouble) return ElementOperator<double, double>(model.partition);
  if (simd_has_half()) return ElementOperator<float, Half>(model.partition);
  return ElementOperator<float, float>(model.partition);
}

}  // namespace

template <class T, class Coef>
ElementOperator<T, Coef>::ElementOperator(std::shared_ptr<const Partition> partition)
    : is_general(partition->num_blocks), offset(partition->num_blocks), partition_(std::move(partition)) {}

template <class T, class Coef>
void ElementOperator<T, Coef>::resize(const std::vector<unsigned char>& kinds) {
  is_general = kinds;
  std::size_t size = 0;
  for (std::size_t block = 0; block < kinds.size(); ++block) {
    offset[block] = size;
    size += kinds[block] || per_sample ? kGeneralCoefficients : kBoxCoefficients;
  }
  coef.resize(size);
  weight.resize(kinds.size() * kBlock * 2 * (per_sample ? kCorners : 1));
}

template class ElementOperator<double, double>;
template class ElementOperator<float, Half>;
template class ElementOperator<float, float>;

Linearization::Linearization(const Model& model)
    : material(slot_vector<double>(*model.partition)),
      present(model.partition->num_blocks),
      is_general(model.partition->num_blocks),
      volume(per_element(model)),
      world(slot_vector<double>(*model.partition)),
      force(slot_vector<double>(*model.partition)),
      screen(per_element(model) * YieldScreen::kQuantities),
      op(operator_of(model)) {}

}  // namespace hexaplast
