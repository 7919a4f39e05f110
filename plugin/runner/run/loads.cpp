// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/loads.hpp"

namespace hexaplast::runner {

PointArray loads_at(double time, scene::Scene& scene, scene::MechanicalState& state) {
  const PointArray& rest = state.rest_positions();
  const PointArray at_rest = PointArray::Zero(rest.rows(), 3);
  PointArray loads = at_rest;
  state.add_external_force(loads);
  for (const scene::Mass* mass : scene::masses_of(scene.root(), state))
    mass->add_gravity(scene.root().clock().gravity, loads);
  for (scene::ForceField* field : scene.root().all<scene::ForceField>())
    if (!field->body() && scene::acts_on(*field, state)) field->add_force(time, rest, at_rest, loads);
  return loads;
}

PointArray free_directions(scene::Scene& scene, scene::MechanicalState& state) {
  NodeMask is_free = NodeMask::Ones(state.num_nodes(), 3);
  for (const scene::ProjectiveConstraint* constraint : scene.root().all<scene::ProjectiveConstraint>())
    if (scene::acts_on(*constraint, state)) constraint->fix(is_free);
  return is_free.cast<double>();
}

}  // namespace hexaplast::runner
