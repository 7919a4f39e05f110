// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/state/history.hpp"

namespace hexaplast {

History::History(const Model& model)
    : rest_shape(model.original_shape),
      rotation_map(model.mesh.num_elements(), Mat3::Identity()),
      yield_stress(model.mesh.num_elements()),
      rotation_yield(model.mesh.num_elements()),
      material(model.mesh.positions()),
      plastic_strain(model.mesh.num_elements(), CornerValues{}) {
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    yield_stress[e].fill(model.material(e).yield_stress);
    rotation_yield[e].fill(model.material(e).rotation_yield);
  }
}

}  // namespace hexaplast
