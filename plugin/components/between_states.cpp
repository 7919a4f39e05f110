// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/between_states.hpp"

#include <fmt/format.h>

#include "parts/contact_options.hpp"

namespace hexaplast::components {
namespace {

bool stands_in(const scene::Node& node, const scene::Node& above) {
  return &node == &above || (node.parent() && stands_in(*node.parent(), above));
}

}  // namespace

scene::OdeSolver& require_one_integrator(scene::Component& component, std::array<scene::MechanicalState*, 2> states) {
  for (scene::MechanicalState* state : states)
    if (state->stage() != scene::Component::Stage::kReady) throw scene::DependencyFailure();
  const std::array integrators = {states[0]->node().nearest<scene::OdeSolver>(),
                                  states[1]->node().nearest<scene::OdeSolver>()};
  if (integrators[0] && integrators[1] && integrators[0] != integrators[1])
    component.reject("object2", fmt::format("leads to '{}', which another time integrator moves than '{}': both need "
                                            "one time integrator and one linear solver in a node above both",
                                            states[1]->name(), states[0]->name()));
  scene::OdeSolver* integrator = integrators[0] ? integrators[0] : integrators[1];
  if (!integrator) component.reject("object1", "no time integrator moves the states: needs one in a node above");
  if (!stands_in(component.node(), integrator->node()))
    component.reject(
        fmt::format("stands outside of the node '{}' of {} '{}', which moves the states: must stand in it "
                    "or below, as in SOFA",
                    integrator->node().path(), integrator->class_name(), integrator->name()));
  return *integrator;
}

scene::ForceField* body_field_on(scene::MechanicalState& state) {
  scene::ForceField* found = nullptr;
  bool has_failed = false;
  for (scene::ForceField* field : state.node().root().all<scene::ForceField>()) {
    if (!scene::acts_on(*field, state)) continue;
    if (field->body()) found = field;
    has_failed = has_failed || field->stage() == scene::Component::Stage::kFailed;
  }
  if (!found && has_failed) throw scene::DependencyFailure();
  return found;
}

Touching find_touching(scene::Component& component, std::span<scene::MechanicalState* const> states) {
  Touching found;
  const bool are_two = states.size() == 2;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const char* object = k == 0 ? "object1" : "object2";
    scene::MechanicalState& state = *states[k];
    const scene::ForceField* field = body_field_on(state);
    if (!field && are_two)
      component.reject(
          object,
          fmt::format("leads to '{}', on which there is no body: contact is that of a body's surface", state.name()));
    if (!field) component.reject("no body on its state: contact is that of a body's surface");
    for (const scene::Mapping* mapping : component.node().root().all<scene::Mapping>()) {
      if (mapping->output() != &state) continue;
      if (!are_two) component.reject("its state follows another one: must be one that an integrator moves");
      component.reject(object, fmt::format("leads to '{}', which follows another state: must lead to one that an "
                                           "integrator moves",
                                           state.name()));
    }
    found.bodies[k] = field->body();
  }
  if (!are_two) found.bodies[1] = found.bodies[0];
  found.integrator = (are_two ? states[0]->node() : component.node()).nearest<scene::OdeSolver>();
  if (are_two && found.integrator != states[1]->node().nearest<scene::OdeSolver>())
    component.reject("object2",
                     fmt::format("leads to '{}', which another integrator moves than '{}': bodies that touch "
                                 "need one EulerImplicitSolver and one linear solver in a node above both",
                                 states[1]->name(), states[0]->name()));
  const std::string lacks = parts::integrator_lacks(
      found.integrator ? found.integrator->class_name() : "",
      [&](const char* scheme) { return found.integrator->boolean(scheme); },
      are_two ? "above the bodies" : "in its node or above");
  if (!lacks.empty()) component.reject(lacks);
  return found;
}

std::optional<Vec3> SpringEnds::at(int node) const {
  if (!surviving_.has({&node, 1})) return std::nullopt;
  return Vec3(state_.positions().row(node).transpose());
}

}  // namespace hexaplast::components
