// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/state/history.hpp"

#include <algorithm>

namespace hexaplast {

namespace {

CornerTensors identities() {
  CornerTensors tensors;
  tensors.fill(Mat3::Identity());
  return tensors;
}

}  // namespace

History::History(const Model& model)
    : rest_shape(model.mesh.num_elements()),
      rotation_map(static_cast<std::size_t>(model.mesh.num_elements()) * model.maps_per_element(), Mat3::Identity()),
      yield_stress(model.mesh.num_elements()),
      rotation_yield(model.mesh.num_elements()),
      material(model.mesh.positions()),
      plastic_strain(model.mesh.num_elements(), CornerValues{}),
      plastic_stretch(model.tracks_plastic_stretch ? model.mesh.num_elements() : 0, identities()),
      alive(model.mesh.num_elements(), 1) {
  averaging_increment.setZero(model.mesh.num_nodes(), 3);
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    rest_shape[e] = model.original_shape(e);
    yield_stress[e].fill(model.material(e).yield_stress);
    rotation_yield[e].fill(model.material(e).rotation_yield);
  }
  removed.reserve(model.mesh.num_elements());  // a step allocates nothing
}

ElementHistory History::element(int e) const {
  ElementHistory element{rest_shape[e],     {},
                         yield_stress[e],   rotation_yield[e],
                         plastic_strain[e], plastic_stretch.empty() ? identities() : plastic_stretch[e]};
  const std::size_t maps = rotation_map.size() / rest_shape.size();
  for (int i = 0; i < kCorners; ++i) element.rotation_map[i] = rotation_map[e * maps + (maps == 1 ? 0 : i)];
  return element;
}

void History::set_element(int e, const ElementHistory& element) {
  rest_shape[e] = element.rest_shape;
  const std::size_t maps = rotation_map.size() / rest_shape.size();
  std::copy_n(element.rotation_map.begin(), maps, rotation_map.begin() + e * maps);
  yield_stress[e] = element.yield_stress;
  rotation_yield[e] = element.rotation_yield;
  plastic_strain[e] = element.plastic_strain;
  if (!plastic_stretch.empty()) plastic_stretch[e] = element.plastic_stretch;
}

}  // namespace hexaplast
