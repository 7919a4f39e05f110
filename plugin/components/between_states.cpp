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

void require_implicit_euler(scene::Component& component, scene::OdeSolver* integrator, std::string_view where) {
  const std::string lacks = parts::integrator_lacks(
      integrator ? integrator->class_name() : "", [&](const char* scheme) { return integrator->boolean(scheme); },
      where);
  if (!lacks.empty()) component.reject(lacks);
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

std::optional<Vec3> SpringEnds::at(int node) const {
  if (!surviving_.has({&node, 1})) return std::nullopt;
  return Vec3(state_.positions().row(node).transpose());
}

}  // namespace hexaplast::components
