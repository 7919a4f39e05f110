// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/parts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/body.hpp"

namespace hexaplast::scene {
namespace {

template <class T>
std::vector<T*> at_least_one(Scene& scene, std::vector<T*> all, const char* what) {
  if (all.empty())
    throw SceneError(format_error(scene.root().place(), fmt::format("no {} in the scene, must be at least one", what)));
  return all;
}

}  // namespace

std::vector<MechanicalState*> moving_states(Scene& scene) {
  integrators_of(scene);
  return at_least_one(scene, independent_states(scene.root()), "mechanical state");
}

std::vector<OdeSolver*> integrators_of(Scene& scene) {
  return at_least_one(scene, scene.root().all<OdeSolver>(), "time integrator");
}

std::vector<SceneBody> bodies_of(Scene& scene) {
  std::vector<SceneBody> bodies;
  for (ForceField* field : scene.root().all<ForceField>()) {
    if (!field->body()) continue;
    std::string name = field->node().name();
    if (!is_plain_name(name) || std::ranges::find(bodies, name, &SceneBody::name) != bodies.end())
      name = fmt::format("body_{}", bodies.size() + 1);
    bodies.push_back({std::move(name), field, field->node().nearest<MechanicalState>()});
  }
  return bodies;
}

FlowReport flow_of(const std::vector<SceneBody>& bodies) {
  FlowReport sum = bodies.empty() ? FlowReport() : *bodies.front().field->flow_report();
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const FlowReport& own = *bodies[i].field->flow_report();
    sum.yielded += own.yielded;
    sum.inverted += own.inverted;
    sum.skipped += own.skipped;
    sum.repaired += own.repaired;
    sum.rolled_back += own.rolled_back;
    sum.removed += own.removed;
    sum.worst_volume_error = std::max(sum.worst_volume_error, own.worst_volume_error);
    sum.averaging.skipped = sum.averaging.skipped && own.averaging.skipped;
    sum.averaging.fell_back = sum.averaging.fell_back || own.averaging.fell_back;
    sum.averaging.iterations += own.averaging.iterations;
    sum.averaging.residual = std::max(sum.averaging.residual, own.averaging.residual);
    sum.averaging.converged = sum.averaging.converged && own.averaging.converged;
  }
  return sum;
}

namespace {

template <class FieldOf>
const PointArray& field_of(const std::vector<MechanicalState*>& states, PointArray& of_all,
                           const FieldOf& field_of_state) {
  if (states.size() == 1) return field_of_state(*states.front());
  Eigen::Index num_nodes = 0;
  for (MechanicalState* state : states) num_nodes += state->num_nodes();
  of_all.resize(num_nodes, 3);
  Eigen::Index first = 0;
  for (MechanicalState* state : states) {
    of_all.middleRows(first, state->num_nodes()) = field_of_state(*state);
    first += state->num_nodes();
  }
  return of_all;
}

}  // namespace

const PointArray& positions_of(const std::vector<MechanicalState*>& states, PointArray& of_all) {
  return field_of(
      states, of_all, [](MechanicalState & state) -> auto& { return state.positions(); });
}

const PointArray& velocities_of(const std::vector<MechanicalState*>& states, PointArray& of_all) {
  return field_of(
      states, of_all, [](MechanicalState & state) -> auto& { return state.velocities(); });
}

std::vector<MechanicalState*> shown_states(Scene& scene) {
  std::vector<MechanicalState*> states;
  for (const SceneBody& body : bodies_of(scene)) states.push_back(body.state);
  return states.empty() ? moving_states(scene) : states;
}

ForceField* find_body(Scene& scene) {
  const std::vector<SceneBody> bodies = bodies_of(scene);
  if (bodies.size() > 1)
    throw SceneError(
        format_error(bodies[1].field->place(), fmt::format("{} '{}': a second body; `bench` takes scenes of one",
                                                           bodies[1].field->class_name(), bodies[1].field->name())));
  return bodies.empty() ? nullptr : bodies[0].field;
}

std::vector<Probe*> probes_of(Scene& scene) {
  std::vector<Probe*> probes = scene.root().all<Probe>();
  for (std::size_t p = 0; p < probes.size(); ++p) {
    const std::string& name = probes[p]->name();
    const auto refuse = [&](const std::string& what) {
      throw SceneError(format_error(probes[p]->place(), fmt::format("Probe '{}': {}", name, what)));
    };
    if (!is_plain_name(name)) refuse("names a column of history.csv: the name must be of letters, digits, _, - and .");
    for (std::size_t other = 0; other < p; ++other)
      if (const std::string& taken = probes[other]->name(); taken == name)
        refuse("a second probe of that name; columns of history.csv need names of their own");
      else if (taken == "probe_" + name || name == "probe_" + taken)
        refuse(fmt::format("its column of history.csv has the name of that of Probe '{}'", taken));
  }
  return probes;
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
