// SPDX-License-Identifier: LGPL-2.1-or-later
#include "state/linearization.hpp"

#include "base/simd.hpp"

namespace hexaplast {

namespace {

std::size_t per_element(const Model& model) { return static_cast<std::size_t>(model.partition->num_blocks) * kBlock; }

bool has_thin_element(const Model& model) {
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    if (is_thin(model, e)) return true;
  return false;
}

decltype(Linearization::op) operator_of(const Model& model) {
  if (model.settings.precision == Precision::kDouble) return ElementOperator<double, double>(model.partition);
  if (simd_has_half() && !has_thin_element(model)) return ElementOperator<float, Half>(model.partition);
  return ElementOperator<float, float>(model.partition);
}

}  // namespace

int num_shape_coefficients(const StiffnessKind& kind, bool is_general) {
  if (kind.one_rotation) return OneRotationPlaces::kCount;
  return is_general ? CoefficientPlaces<true, Assumed::kCorner>::kCount
                    : CoefficientPlaces<false, Assumed::kCorner>::kCount;
}

int num_coefficients(const StiffnessKind& kind, bool is_general) {
  return num_shape_coefficients(kind, is_general) + (kind.has_volume() + kind.has_mean()) * kGradientCoefficients +
         (kind.has_law() ? kLawCoefficients : 0);
}

template <class T, class Coef>
ElementOperator<T, Coef>::ElementOperator(std::shared_ptr<const Partition> partition)
    : is_general(partition->num_blocks), offset(partition->num_blocks), partition_(std::move(partition)) {}

template <class T, class Coef>
void ElementOperator<T, Coef>::resize(const std::vector<unsigned char>& kinds, const unsigned char* has_coefficients) {
  is_general = kinds;
  std::size_t size = 0;
  for (std::size_t block = 0; block < kinds.size(); ++block) {
    offset[block] = size;
    if (has_coefficients && !has_coefficients[block]) continue;
    size += static_cast<std::size_t>(kBlock) * num_coefficients(kind, kinds[block]);
  }
  coef.resize(size);
  weight.resize(kinds.size() * kBlock * 2);
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
