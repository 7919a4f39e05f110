// SPDX-License-Identifier: LGPL-2.1-or-later
#include "state/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include "hexaplast/base/error.hpp"

namespace hexaplast {

namespace {

CornerTensors identities() {
  CornerTensors tensors;
  tensors.fill(Mat3::Identity());
  return tensors;
}

void require(bool holds, std::string_view what) {
  if (!holds) throw InputError(fmt::format("the plastic history does not belong to this body: {}", what));
}

template <class Holds>
bool all_values(const std::vector<CornerValues>& values, const Holds& holds) {
  return std::ranges::all_of(values, [&](const CornerValues& corners) { return std::ranges::all_of(corners, holds); });
}

}  // namespace

bool is_flowed(const CornerTensors& plastic_inverse) {
  return std::ranges::any_of(plastic_inverse, [](const Mat3& G) { return G != Mat3::Identity(); });
}

History::History(const Model& model)
    : yield_stress(model.mesh.num_elements()),
      rotation_yield(model.can_rotate ? model.mesh.num_elements() : 0),
      plastic_rest_positions(model.mesh.positions()),
      plastic_strain(model.mesh.num_elements(), CornerValues{}),
      plastic_stretch(model.tracks_plastic_stretch ? model.mesh.num_elements() : 0, identities()),
      alive(model.mesh.num_elements(), 1),
      branch_strain(static_cast<std::size_t>(model.mesh.num_elements()) * model.settings.num_branches(),
                    CornerSymmetric{}),
      branch_stretch(model.settings.num_branches() > 0 ? model.mesh.num_elements() : 0, CornerSymmetric{}) {
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    yield_stress[e].fill(model.material(e).yield_stress);
    if (model.can_rotate) rotation_yield[e].fill(model.material(e).rotation_yield);
  }
  if (model.has_rest_shapes()) add_rest_shapes(model);
  if (model.can_flow_isolated()) add_plastic_inverse();
  removed.reserve(model.mesh.num_elements());  // a step allocates nothing
}

ElementHistory History::element(const Model& model, int e) const {
  ElementHistory element{rest_shape.empty() ? model.initial_shape(e) : rest_shape[e],
                         identities(),
                         yield_stress[e],
                         rotation_yield.empty() ? CornerValues{} : rotation_yield[e],
                         plastic_strain[e],
                         plastic_stretch.empty() ? identities() : plastic_stretch[e],
                         plastic_inverse.empty() ? identities() : plastic_inverse[e]};
  const std::size_t maps = model.maps_per_element();
  for (int i = 0; i < kCorners && !rotation_map.empty(); ++i)
    element.rotation_map[i] = rotation_map[e * maps + (maps == 1 ? 0 : i)];
  return element;
}

void History::set_element(int e, const ElementHistory& element) {
  if (!rest_shape.empty()) {
    rest_shape[e] = element.rest_shape;
    const std::size_t maps = rotation_map.size() / rest_shape.size();
    std::copy_n(element.rotation_map.begin(), maps, rotation_map.begin() + e * maps);
  }
  yield_stress[e] = element.yield_stress;
  if (!rotation_yield.empty()) rotation_yield[e] = element.rotation_yield;
  plastic_strain[e] = element.plastic_strain;
  if (!plastic_stretch.empty()) plastic_stretch[e] = element.plastic_stretch;
  if (plastic_inverse.empty()) return;
  plastic_inverse[e] = element.plastic_inverse;
  has_flowed[e] = is_flowed(plastic_inverse[e]);
}

void History::add_rest_shapes(const Model& model) {
  if (!rest_shape.empty()) return;
  for (int e = 0; e < model.mesh.num_elements(); ++e) rest_shape.push_back(model.initial_shape(e));
  rotation_map.resize(rest_shape.size() * model.maps_per_element(), Mat3::Identity());
  averaging_increment.setZero(model.mesh.num_nodes(), 3);
}

void History::add_plastic_inverse() {
  plastic_inverse.resize(alive.size(), identities());
  has_flowed.resize(alive.size());
}

void History::add_nodes(std::span<const int> parents) {
  append_rows(parents, plastic_rest_positions);
  if (averaging_increment.rows() > 0) append_rows(parents, averaging_increment);
}

bool History::has_isolated_flow() const {
  for (std::size_t e = 0; e < has_flowed.size(); ++e)
    if (has_flowed[e] && alive[e]) return true;
  return false;
}

// By sums, which take a fraction of the time and are no numbers where one of their terms is none.
bool History::is_finite(int e) const {
  const auto sum = [](const CornerValues& corners) {
    return Eigen::Map<const Eigen::Array<double, kCorners, 1>>(corners.data()).sum();
  };
  double numbers = sum(plastic_strain[e]), thresholds = sum(yield_stress[e]);
  if (!rest_shape.empty()) {
    const std::size_t maps = rotation_map.size() / rest_shape.size();
    numbers += rest_shape[e].sum();
    for (std::size_t m = 0; m < maps; ++m) numbers += rotation_map[e * maps + m].sum();
  }
  for (const auto* tensors : {&plastic_stretch, &plastic_inverse})
    if (!tensors->empty())
      for (const Mat3& tensor : (*tensors)[e]) numbers += tensor.sum();
  if (!rotation_yield.empty()) thresholds += sum(rotation_yield[e]);
  for (const CornerSymmetric& strain : branch_strains_of(e))
    for (const auto& corner : strain) numbers += std::accumulate(corner.begin(), corner.end(), 0.0);
  return std::isfinite(numbers) && !std::isnan(thresholds);
}

void History::serialize(Archive& archive) {
  archive(rest_shape, rotation_map, yield_stress, rotation_yield, plastic_rest_positions, plastic_strain,
          plastic_stretch, plastic_inverse, dissipated_energy, alive, removed, averaging_increment, branch_strain,
          branch_stretch, opened, crossings, end_of_opening);
  if (!archive.reads()) return;
  removed.reserve(alive.size());  // a step allocates nothing
  has_flowed.resize(plastic_inverse.size());
  std::ranges::transform(plastic_inverse, has_flowed.begin(), is_flowed);
}

void validate_opened(const Model& model, const History& history) {
  require(history.crossings.size() == history.opened.size() && std::ranges::all_of(history.crossings, is_crossing),
          "the crossings of its opened joints are not of them, or not in [0, 1]");
  if (history.opened.empty() && history.end_of_opening.empty()) return;
  std::vector<unsigned char> is_open(model.joints().count(), 0);
  std::size_t at = 0;
  for (const int end : history.end_of_opening) {
    require(end > static_cast<int>(at) && end <= std::ssize(history.opened), "its calls of `open` do not add up");
    for (const std::size_t first = at; at < static_cast<std::size_t>(end); ++at) {
      const int joint = history.opened[at];
      require(joint >= 0 && joint < std::ssize(is_open) && !is_open[joint] &&
                  (at == first || joint > history.opened[at - 1]),
              "its opened joints do not exist, or opened twice");
      is_open[joint] = 1;
    }
  }
  require(at == history.opened.size(), "its calls of `open` do not add up");
}

void validate(const Model& model, const History& history) {
  const auto num_elements = static_cast<std::size_t>(model.mesh.num_elements());
  const Eigen::Index num_nodes = model.mesh.num_nodes();
  require((history.rest_shape.empty() || history.rest_shape.size() == num_elements) &&
              history.yield_stress.size() == num_elements && history.plastic_strain.size() == num_elements &&
              history.alive.size() == num_elements,
          "it is of another number of hexahedra");
  require(history.plastic_rest_positions.rows() == num_nodes, "it is of another number of nodes");
  require((history.rest_shape.empty() ? !model.has_rest_shapes() : model.settings.rest_shape == RestShape::kJoined) &&
              history.rotation_map.size() == history.rest_shape.size() * model.maps_per_element() &&
              history.averaging_increment.rows() == (history.rest_shape.empty() ? 0 : num_nodes) &&
              history.plastic_stretch.size() == (model.tracks_plastic_stretch ? num_elements : 0) &&
              (history.plastic_inverse.empty() ? !model.can_flow_isolated()
                                               : history.plastic_inverse.size() == num_elements &&
                                                     model.settings.rest_shape == RestShape::kIsolated) &&
              history.branch_strain.size() == num_elements * model.settings.num_branches() &&
              history.branch_stretch.size() == (model.settings.num_branches() > 0 ? num_elements : 0) &&
              (history.rotation_yield.size() == num_elements || (history.rotation_yield.empty() && !model.can_rotate)),
          "it is of other settings or materials");

  const auto is_threshold = [](double value) { return value >= 0; };
  require(all_values(history.yield_stress, is_threshold) && all_values(history.rotation_yield, is_threshold),
          "a yield threshold is negative or no number");
  require(history.plastic_rest_positions.allFinite() && history.averaging_increment.allFinite() &&
              std::isfinite(history.dissipated_energy),
          "a value is not finite");
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    require(history.is_finite(e), fmt::format("a value of hexahedron {} is not finite", e));

  for (const CornerTensors& G : history.plastic_inverse)
    for (const Mat3& one : G) require(one.determinant() > 0, "a plastic deformation is no deformation");
  require(history.plastic_inverse.empty() || history.plastic_rest_positions == model.mesh.positions(),
          "it has moved plastic rest positions");

  std::vector<unsigned char> left(num_elements, 1);
  for (const int e : history.removed) {
    require(e >= 0 && e < model.mesh.num_elements() && left[e], "its removed hexahedra do not exist, or went twice");
    left[e] = 0;
  }
  require(left == history.alive, "removed hexahedra and those that are left do not add up");
}

}  // namespace hexaplast
