// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/mechanical_system.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "scene/interfaces.hpp"
#include "scene/parts.hpp"

namespace hexaplast::components {
namespace {

/// All that a system is made of is a component.
template <class Of>
scene::Component& component_of(const Of& of) {
  return const_cast<scene::Component&>(dynamic_cast<const scene::Component&>(of));
}

}  // namespace

NodeSystem::NodeSystem(scene::Node& node) : LayeredSystem(node.clock().gravity), node_(node) {
  find_states();
  for (Layer& layer : layers_) {
    auto& state = dynamic_cast<scene::MechanicalState&>(*layer.state);
    for (scene::Mass* mass : scene::masses_of(node, state)) layer.masses.push_back(mass);
    for (scene::ForceField* field : node.all<scene::ForceField>())
      if (scene::acts_on(*field, state)) layer.forces.push_back(field);
  }
  // They may stand anywhere in the scene. Where one of both states is not ours, nothing moves it, or the scene is
  // rejected.
  node.root().for_each<scene::Interaction>([&](scene::Interaction& field) {
    const std::array<scene::MechanicalState*, 2> states = field.states();
    if (layer_of(states[0]) != kAtRest || layer_of(states[1]) != kAtRest)
      add_interaction(field, {states[0], states[1]});
  });
  find_loaded();
  find_constraints();
}

// Each pass adds the states whose input is there already.
void NodeSystem::find_states() {
  for (scene::MechanicalState* state : scene::independent_states(node_)) {
    if (state->node().local<scene::MechanicalState>() != state)
      state->reject("a second state in its node, must be one");
    add_state(*state);
  }
  if (num_roots_ == 0) throw InputError("no mechanical state in its node and below, must be at least one");
  std::vector<scene::Mapping*> left = node_.all<scene::Mapping>();
  std::erase_if(left, [](const scene::Mapping* mapping) { return !mapping->output(); });
  for (std::size_t before = left.size() + 1; left.size() < before && !left.empty();) {
    before = left.size();
    std::erase_if(left, [&](scene::Mapping* mapping) {
      const std::size_t above = layer_of(mapping->input());
      if (above != kAtRest) add_state(*mapping->output(), *mapping, above);
      return above != kAtRest;
    });
  }
  if (!left.empty()) left[0]->reject("follows no state that the solver moves");
}

void NodeSystem::find_constraints() {
  node_.for_each<scene::Component>([&](scene::Component& component) {
    const auto* of_two = dynamic_cast<scene::InteractionProjectiveConstraint*>(&component);
    Constraint constraint{.of_one = dynamic_cast<scene::ProjectiveConstraint*>(&component), .of_two = of_two};
    if (constraint.of_one) {
      const auto constrained = std::ranges::find_if(layers_, [&](const Layer& layer) {
        return scene::acts_on(component, dynamic_cast<const scene::MechanicalState&>(*layer.state));
      });
      if (constrained == layers_.end() || constrained->mapping)
        component.reject("constrains a state that follows another one");
      constraint.layers.fill(static_cast<std::size_t>(constrained - layers_.begin()));
    } else if (of_two) {
      for (std::size_t end = 0; end < 2; ++end) {
        const scene::MechanicalState* state = of_two->states()[end];
        const char* object = end == 0 ? "object1" : "object2";
        constraint.layers[end] = layer_of(state);
        if (constraint.layers[end] == kAtRest)
          component.reject(
              object, fmt::format("leads to '{}', which the time integrator of the node does not move", state->name()));
        if (layers_[constraint.layers[end]].mapping && (end == 1 || of_two->couples()))
          component.reject(object, fmt::format("leads to '{}', which follows another state: must lead to one that an "
                                               "integrator moves",
                                               state->name()));
      }
    } else {
      return;
    }
    constraints_.push_back(constraint);
  });
  require_commuting();
}

void NodeSystem::require_commuting() {
  constraints_changed_ = false;
  for (const Constraint& constraint : constraints_)
    if (constraint.couples()) require_commuting(constraint);
}

/// Projections of which one undoes what the other has done make none together.
void NodeSystem::require_commuting(const Constraint& constraint) const {
  for (const Constraint& other : constraints_) {
    if (&other == &constraint) continue;
    PointArray one = irregular_numbers(num_nodes()), two = one;
    project(constraint, one);
    project(other, one);
    project(other, two);
    project(constraint, two);
    if ((one - two).cwiseAbs().maxCoeff() < 1e-12) continue;
    const scene::Component& of_other = other.of_one ? component_of(*other.of_one) : component_of(*other.of_two);
    component_of(*constraint.of_two)
        .reject(fmt::format("ties nodes that {} '{}' constrains too: each node must have one of both",
                            of_other.class_name(), of_other.name()));
  }
}

void NodeSystem::require_matrix(const std::string& why) const {
  const std::string hint = fmt::format("but {} needs one: take a MultigridCGLinearSolver or a CGLinearSolver", why);
  for (const Interaction& interaction : interactions_)
    for (std::size_t end = 0; end < 2; ++end)
      if (interaction.layers[end] != kAtRest && layers_[interaction.layers[end]].mapping)
        component_of(*interaction.forces)
            .reject(end == 0 ? "object1" : "object2",
                    fmt::format("leads to '{}', which follows another state: no matrix has that, {}",
                                component_of(*interaction.states[end]).name(), hint));
  for (const Constraint& constraint : constraints_)
    if (constraint.couples())
      component_of(*constraint.of_two)
          .reject("twoWay", fmt::format("ties nodes in both ways: no matrix has that, {}", hint));
}

ConstPoints NodeSystem::rows_of_state(const scene::MechanicalState& state, ConstPoints of_all) const {
  const std::size_t layer = layer_of(&state);
  if (layer >= num_roots_) throw InputError("a state is asked for that the time integrator does not move");
  return rows_of(layers_[layer], of_all);
}

int NodeSystem::first_node_of(const scene::MechanicalState& state) const {
  const std::size_t layer = layer_of(&state);
  return layer < num_roots_ ? layers_[layer].first_node : -1;
}

void NodeSystem::require_mass() const {
  std::vector<bool> has_mass(layers_.size());
  for (std::size_t i = layers_.size(); i-- > 0;) {
    has_mass[i] = has_mass[i] || !layers_[i].masses.empty();
    if (layers_[i].mapping && has_mass[i]) has_mass[layers_[i].above] = true;
    if (layers_[i].mapping || has_mass[i]) continue;
    const scene::Component& state = component_of(*layers_[i].state);
    throw InputError(fmt::format("no mass on {} '{}' of its node and below", state.class_name(), state.name()));
  }
}

template <class Visit>
void NodeSystem::for_each_body(const Visit& visit) const {
  for (const Layer& layer : layers_)
    for (const NodalForces* forces : layer.forces)
      if (forces->is_body()) visit(dynamic_cast<const scene::ForceField&>(*forces), layer);
}

double NodeSystem::elastic_energy() const {
  double energy = 0;
  for_each_body([&](const scene::ForceField& body, const Layer& layer) {
    if (const auto* potential = dynamic_cast<const scene::Potential*>(&body))
      energy += potential->potential_energy(node_.clock().time, layer.state->positions());
  });
  return energy;
}

double NodeSystem::recovery_work() const {
  double work = 0;
  for_each_body([&](const scene::ForceField& body, const Layer& layer) {
    work += body.body()->recovery_work(layer.state->positions());
  });
  return work;
}

ModelCheck NodeSystem::check(const scene::ForceField& body, const Layer& layer) const {
  auto& state = dynamic_cast<scene::MechanicalState&>(*layer.state);
  return check_model(*body.body(), scene::total_mass(scene::masses_of(node_, state), state), node_.clock().dt);
}

double NodeSystem::highest_frequency() const {
  double frequency = 0;
  for_each_body([&](const scene::ForceField& body, const Layer& layer) {
    frequency = std::max(frequency, check(body, layer).highest_frequency);
  });
  return frequency;
}

void NodeSystem::warn_of_sizes() const {
  for_each_body([&](const scene::ForceField& body, const Layer& layer) {
    for (const std::string& sentence : size_warnings(check(body, layer), node_.clock().gravity))
      component_of(body).remark(scene::Severity::kWarning, "", sentence);
  });
}

}  // namespace hexaplast::components
