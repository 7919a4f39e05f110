// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/parts.hpp"

#include <fmt/format.h>

namespace hexaplast::scene {
namespace {

template <class T>
T& only_one(Scene& scene, const std::vector<T*>& all, const char* what) {
  if (all.size() != 1) {
    const std::string place =
        all.empty() ? "" : fmt::format("; the second one is {} '{}'", all[1]->class_name(), all[1]->name());
    throw SceneError(
        format_error(all.empty() ? scene.root().place() : all[1]->place(),
                     fmt::format("{} {} in the scene, a run moves exactly one{}", all.size(), what, place)));
  }
  return *all[0];
}

}  // namespace

MechanicalState& only_state(Scene& scene) {
  return only_one(scene, independent_states(scene.root()), "mechanical states");
}

OdeSolver& only_solver(Scene& scene) { return only_one(scene, scene.root().all<OdeSolver>(), "time integrators"); }

ForceField* find_body(Scene& scene) {
  ForceField* found = nullptr;
  for (ForceField* field : scene.root().all<ForceField>()) {
    if (!field->body()) continue;
    if (found) {
      throw SceneError(format_error(field->place(), fmt::format("{} '{}': a second body; a run has at most one",
                                                                field->class_name(), field->name())));
    }
    found = field;
  }
  return found;
}

// Found by its class, because the component itself lives in a plugin.
Component* find_settings(Scene& scene) {
  for (Component* component : scene.root().all<Component>())
    if (component->class_name() == "RunSettings") return component;
  return nullptr;
}

// Weight [N] under a gravity of 1 m/s^2 is the mass.
double total_mass(const std::vector<Mass*>& masses, MechanicalState& state) {
  PointArray weight = PointArray::Zero(state.num_nodes(), 3);
  for (const Mass* mass : masses) mass->add_gravity(Vec3::UnitX(), weight);
  return weight.col(0).sum();
}

}  // namespace hexaplast::scene
