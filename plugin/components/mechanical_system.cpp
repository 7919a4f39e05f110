// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/mechanical_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "model_check.hpp"
#include "scene/parts.hpp"
#include "scene/potential.hpp"

namespace hexaplast::components {

NodeSystem::NodeSystem(scene::Node& node) : node_(node) {
  for (scene::MechanicalState* state : scene::independent_states(node)) {
    if (state->node().local<scene::MechanicalState>() != state)
      state->reject("a second state in its node, must be one");
    layers_.push_back({.state = state, .first_node = num_nodes_});
    num_nodes_ += state->num_nodes();
  }
  num_roots_ = layers_.size();
  if (num_roots_ == 0) throw InputError("no mechanical state in its node and below, must be at least one");
  add_layers(node);

  for (Layer& layer : layers_) {
    layer.masses = scene::masses_of(node, *layer.state);
    for (scene::ForceField* field : node.all<scene::ForceField>())
      if (scene::acts_on(*field, *layer.state)) layer.force_fields.push_back(field);
  }
  find_interactions();
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    PointArray external = PointArray::Zero(layer.state->num_nodes(), 3);
    layer.state->add_external_force(external);
    layer.is_loaded = layer.is_loaded || !layer.masses.empty() || !layer.force_fields.empty() || !external.isZero(0);
    if (layer.is_loaded) layers_[layer.above].is_loaded = true;
  }
  find_constraints();
}

bool NodeSystem::is_ours(const scene::MechanicalState* state) const {
  return std::ranges::find(layers_, state, &Layer::state) != layers_.end();
}

std::size_t NodeSystem::layer_of(const scene::MechanicalState* state) const {
  return static_cast<std::size_t>(std::ranges::find(layers_, state, &Layer::state) - layers_.begin());
}

// They may stand anywhere in the scene. Where one of both states is not ours, nothing moves it, or the scene is
// rejected.
void NodeSystem::find_interactions() {
  node_.root().for_each<scene::Interaction>([&](scene::Interaction& field) {
    const std::array<scene::MechanicalState*, 2> states = field.states();
    if (!is_ours(states[0]) && !is_ours(states[1])) return;
    Interaction interaction{.field = &field};
    for (int end = 0; end < 2; ++end) {
      if (!is_ours(states[end])) {
        interaction.layers[end] = kAtRest;
        interaction.zero = interaction.scratch = PointArray::Zero(states[end]->num_nodes(), 3);
        continue;
      }
      interaction.layers[end] = layer_of(states[end]);
      Layer& layer = layers_[interaction.layers[end]];
      if (!layer.mapping) continue;
      layer.is_loaded = true;
      interaction.is_of_roots = false;
    }
    interactions_.push_back(std::move(interaction));
  });
}

void NodeSystem::find_constraints() {
  node_.for_each<scene::Component>([&](scene::Component& component) {
    Constraint constraint{.of_one = dynamic_cast<scene::ProjectiveConstraint*>(&component),
                          .of_two = dynamic_cast<scene::InteractionProjectiveConstraint*>(&component)};
    if (constraint.of_one) {
      const auto constrained =
          std::ranges::find_if(layers_, [&](const Layer& layer) { return scene::acts_on(component, *layer.state); });
      if (constrained == layers_.end() || constrained->mapping)
        component.reject("constrains a state that follows another one");
      constraint.layers.fill(static_cast<std::size_t>(constrained - layers_.begin()));
    } else if (constraint.of_two) {
      for (int end = 0; end < 2; ++end) {
        scene::MechanicalState* state = constraint.of_two->states()[end];
        const char* object = end == 0 ? "object1" : "object2";
        if (!is_ours(state))
          component.reject(
              object, fmt::format("leads to '{}', which the time integrator of the node does not move", state->name()));
        constraint.layers[end] = layer_of(state);
        if (layers_[constraint.layers[end]].mapping && (end == 1 || constraint.of_two->couples()))
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
    if (constraint.of_two && constraint.of_two->couples()) require_commuting(constraint);
}

/// Projections of which one undoes what the other has done make none together.
void NodeSystem::require_commuting(const Constraint& constraint) const {
  for (const Constraint& other : constraints_) {
    if (&other == &constraint) continue;
    PointArray one = irregular_numbers(num_nodes_), two = one;
    project(constraint, one);
    project(other, one);
    project(other, two);
    project(constraint, two);
    if ((one - two).cwiseAbs().maxCoeff() < 1e-12) continue;
    const scene::Component& of_other = other.of_one ? static_cast<scene::Component&>(*other.of_one) : *other.of_two;
    constraint.of_two->reject(fmt::format("ties nodes that {} '{}' constrains too: each node must have one of both",
                                          of_other.class_name(), of_other.name()));
  }
}

void NodeSystem::gather() {
  x_.resize(num_nodes_, 3);
  v_.resize(num_nodes_, 3);
  for (const Layer& root : roots()) {
    rows_of<Points>(root, x_) = root.state->positions();
    rows_of<Points>(root, v_) = root.state->velocities();
  }
}

void NodeSystem::scatter() const {
  for (const Layer& root : roots()) {
    root.state->positions() = rows_of<ConstPoints>(root, x_);
    root.state->velocities() = rows_of<ConstPoints>(root, v_);
  }
}

const PointArray& NodeSystem::positions() {
  if (num_roots_ == 1) return root(0).state->positions();
  gather();
  return x_;
}

const PointArray& NodeSystem::velocities() {
  if (num_roots_ == 1) return root(0).state->velocities();
  gather();
  return v_;
}

// Each pass adds the states whose input is there already.
void NodeSystem::add_layers(scene::Node& node) {
  std::vector<scene::Mapping*> left = node.all<scene::Mapping>();
  std::erase_if(left, [](const scene::Mapping* mapping) { return !mapping->output(); });
  for (std::size_t before = left.size() + 1; left.size() < before && !left.empty();) {
    before = left.size();
    std::erase_if(left, [&](scene::Mapping* mapping) {
      const auto above = std::ranges::find(layers_, mapping->input(), &Layer::state);
      if (above == layers_.end()) return false;
      const auto index = static_cast<std::size_t>(above - layers_.begin());
      const PointArray none = PointArray::Zero(mapping->output()->num_nodes(), 3);
      layers_.push_back(
          {.state = mapping->output(), .mapping = mapping, .above = index, .x = none, .v = none, .f = none});
      return true;
    });
  }
  if (!left.empty()) left[0]->reject("follows no state that the solver moves");
}

void NodeSystem::add_force(Over over, const Layer& layer, double time, ConstPoints x, ConstPoints v, Points f) const {
  if (over != Over::kDampers) {
    layer.state->add_external_force(f);
    for (const scene::Mass* mass : layer.masses) mass->add_gravity(node_.clock().gravity, f);
  }
  for (scene::ForceField* field : layer.force_fields)
    if (over == Over::kAll || (over == Over::kDampers ? field->damps_explicitly() : !field->body()))
      field->add_force(time, x, v, f);
}

void NodeSystem::compute_force(double time, ConstPoints x, ConstPoints v, Points f) {
  f.setZero();
  add_force(Over::kAll, time, x, v, f);
}

void NodeSystem::add_load(double time, ConstPoints x, ConstPoints v, Points f) {
  add_force(Over::kLoads, time, x, v, f);
}

void NodeSystem::add_force(Over over, double time, ConstPoints x, ConstPoints v, Points f) const {
  for (const Layer& root : roots()) add_force(over, root, time, rows_of(root, x), rows_of(root, v), rows_of(root, f));

  // down, and up again: those that follow before those that they follow
  for (Layer& layer : followers()) {
    if (!layer.is_loaded) continue;
    layer.mapping->apply(part_of(layer.above, x, &Layer::x), layer.x);
    layer.mapping->apply(part_of(layer.above, v, &Layer::v), layer.v);
    layer.f.setZero();
    add_force(over, layer, time, layer.x, layer.v, layer.f);
  }
  add_interaction_forces(over, false, time, x, v, f);
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    if (layer.is_loaded) layer.mapping->add_transposed(layer.f, part_of(layer.above, f, &Layer::f));
  }
  add_interaction_forces(over, true, time, x, v, f);
}

void NodeSystem::add_interaction_forces(Over over, bool of_roots, double time, ConstPoints x, ConstPoints v,
                                        Points f) const {
  for (Interaction& interaction : interactions_)
    if (interaction.is_of_roots == of_roots && (over != Over::kDampers || interaction.field->damps_explicitly()))
      interaction.field->add_force(time, positions_of(interaction, x), velocities_of(interaction, v),
                                   forces_of(interaction, f));
}

OfTwo<ConstPoints> NodeSystem::positions_of(const Interaction& interaction, ConstPoints x) const {
  const auto of = [&](int end) {
    return part_of<ConstPoints>(interaction, end, x, &Layer::x, interaction.field->states()[end]->positions());
  };
  return {of(0), of(1)};
}

OfTwo<ConstPoints> NodeSystem::velocities_of(const Interaction& interaction, ConstPoints v) const {
  const auto of = [&](int end) {
    return part_of<ConstPoints>(interaction, end, v, &Layer::v, interaction.field->states()[end]->velocities());
  };
  return {of(0), of(1)};
}

OfTwo<ConstPoints> NodeSystem::increments_of(const Interaction& interaction, ConstPoints dx) const {
  const auto of = [&](int end) { return part_of<ConstPoints>(interaction, end, dx, &Layer::x, interaction.zero); };
  return {of(0), of(1)};
}

OfTwo<Points> NodeSystem::forces_of(Interaction& interaction, Points f) const {
  interaction.scratch.setZero();
  const auto of = [&](int end) { return part_of<Points>(interaction, end, f, &Layer::f, interaction.scratch); };
  return {of(0), of(1)};
}

// A mass damps by its own factor, a force field by its own: both through the damping factor b of m M + b B + k K.
// Factors of 0 are common where energies are measured, and a product of a body costs as much with them.
void NodeSystem::add_product(Over over, const Layer& layer, const OperatorFactors& factors, ConstPoints dx, Points df) {
  const bool has_masses = over == Over::kAll || (over == Over::kOthers && layer.mapping);
  if (has_masses)
    for (const scene::Mass* mass : layer.masses)
      mass->add_product(factors.mass - factors.damping * mass->rayleigh_mass(), dx, df);
  const auto add_fields = [&](const auto& fields) {
    for (const scene::ForceField* field : fields) {
      if (over == Over::kLoads && field->body()) continue;
      const double stiffness = factors.stiffness + factors.damping * field->rayleigh_stiffness();
      if (stiffness != 0) field->add_stiffness_product(stiffness, dx, df);
      if (factors.damping != 0) field->add_damping_product(factors.damping, dx, df);
    }
  };
  if (over == Over::kOthers)
    add_fields(layer.other_fields);
  else
    add_fields(layer.force_fields);
}

void NodeSystem::add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  add_product(Over::kAll, factors, dx, df);
}

void NodeSystem::add_load_product(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  add_product(Over::kLoads, factors, dx, df);
}

void NodeSystem::Others::add_product(ConstPoints p, Points Fp) const {
  system_->add_product(Over::kOthers, factors, p, Fp);
}

void NodeSystem::add_product(Over over, const OperatorFactors& factors, ConstPoints dx, Points df) const {
  const auto takes_part = [&](const Layer& layer) {
    return over == Over::kOthers ? layer.has_others : layer.is_loaded;
  };
  for (const Layer& root : roots()) add_product(over, root, factors, rows_of(root, dx), rows_of(root, df));
  for (Layer& layer : followers()) {
    if (!takes_part(layer)) continue;
    layer.mapping->apply(part_of(layer.above, dx, &Layer::x), layer.x);
    layer.f.setZero();
    add_product(over, layer, factors, layer.x, layer.f);
  }
  add_interactions(false, factors, dx, df);
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    if (takes_part(layer)) layer.mapping->add_transposed(layer.f, part_of(layer.above, df, &Layer::f));
  }
  add_interactions(true, factors, dx, df);
}

void NodeSystem::add_interactions(bool of_roots, const OperatorFactors& factors, ConstPoints dx, Points df) const {
  for (Interaction& interaction : interactions_) {
    const scene::Interaction* field = interaction.field;
    if (interaction.is_of_roots != of_roots || !field->is_in_matrix()) continue;
    const double stiffness = factors.stiffness + factors.damping * field->rayleigh_stiffness();
    if (stiffness != 0)
      field->add_stiffness_product(stiffness, increments_of(interaction, dx), forces_of(interaction, df));
    if (factors.damping != 0)
      field->add_damping_product(factors.damping, increments_of(interaction, dx), forces_of(interaction, df));
  }
}

void NodeSystem::add_blocks(const Layer& layer, const OperatorFactors& factors, BlockMatrix& A) {
  for (const scene::Mass* mass : layer.masses)
    mass->add_blocks(factors.mass - factors.damping * mass->rayleigh_mass(), A);
  for (const scene::ForceField* field : layer.force_fields) {
    field->add_stiffness_blocks(factors.stiffness + factors.damping * field->rayleigh_stiffness(), A);
    field->add_damping_blocks(factors.damping, A);
  }
}

void NodeSystem::add_blocks(const OperatorFactors& factors, BlockMatrix& A) const {
  for (const Layer& root : roots()) {
    A.set_range(root.first_node, root.state->num_nodes());
    add_blocks(root, factors, A);
  }
  for (Layer& layer : followers()) {
    if (!layer.is_loaded) continue;
    if (layer.blocks.num_nodes() == 0) layer.blocks = BlockMatrix(layer.state->num_nodes());
    layer.blocks.clear();
    add_blocks(layer, factors, layer.blocks);
  }
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    if (!layer.is_loaded) continue;
    layer.blocks.drop_unused();
    Layer& above = layers_[layer.above];
    if (!above.mapping) A.set_range(above.first_node, above.state->num_nodes());
    layer.mapping->add_transposed_blocks(layer.blocks, above.mapping ? above.blocks : A);
  }
  A.set_whole_range();
  for (const Interaction& interaction : interactions_) {
    const scene::Interaction* field = interaction.field;
    std::array<int, 2> first_nodes = {};
    for (int end = 0; end < 2; ++end)
      first_nodes[end] = interaction.layers[end] == kAtRest ? -1 : root(interaction.layers[end]).first_node;
    field->add_stiffness_blocks(factors.stiffness + factors.damping * field->rayleigh_stiffness(), A, first_nodes);
    field->add_damping_blocks(factors.damping, A, first_nodes);
  }
}

void NodeSystem::require_matrix(const std::string& why) const {
  const std::string hint = fmt::format("but {} needs one: take a MultigridCGLinearSolver or a CGLinearSolver", why);
  for (const Interaction& interaction : interactions_) {
    const auto follows = [&](std::size_t end) {
      return interaction.layers[end] != kAtRest && layers_[interaction.layers[end]].mapping;
    };
    if (!follows(0) && !follows(1)) continue;
    const std::size_t end = follows(0) ? 0 : 1;
    dynamic_cast<scene::Component*>(interaction.field)
        ->reject(end == 0 ? "object1" : "object2",
                 fmt::format("leads to '{}', which follows another state: no matrix has that, {}",
                             layers_[interaction.layers[end]].state->name(), hint));
  }
  for (const Constraint& constraint : constraints_)
    if (constraint.of_two && constraint.of_two->couples())
      constraint.of_two->reject("twoWay", fmt::format("ties nodes in both ways: no matrix has that, {}", hint));
}

bool NodeSystem::describe(const OperatorFactors& factors, MatrixFreeSystem& system) const {
  if (num_roots_ == 1) {
    describe(root(0), factors, system);
  } else {
    for (Layer& root : roots()) {
      root.part.clear();
      root.part.wants_coarse = system.wants_coarse;
      root.part.diagonal.setZero(root.state->num_nodes(), 3);
      describe(root, factors, root.part);
      system.add_part(root.part, root.first_node);
    }
  }
  find_others();
  others_.factors = factors;
  const bool interact = std::ranges::any_of(
      interactions_, [](const Interaction& interaction) { return interaction.field->is_in_matrix(); });
  if (interact || std::ranges::any_of(roots(), &Layer::has_others)) system.others.emplace_back(&others_);
  return true;
}

/// What the kernels know of what acts on an independent state; it keeps what they do not.
void NodeSystem::describe(Layer& layer, const OperatorFactors& factors, MatrixFreeSystem& system) const {
  layer.other_fields.clear();
  for (const scene::Mass* mass : layer.masses)
    mass->add_diagonal(factors.mass - factors.damping * mass->rayleigh_mass(), system.diagonal);
  for (const scene::ForceField* field : layer.force_fields) {
    if (!field->is_in_matrix()) continue;
    if (field->describe(factors.stiffness + factors.damping * field->rayleigh_stiffness(), system))
      field->add_damping_diagonal(factors.damping, system.diagonal);
    else
      layer.other_fields.push_back(field);
  }
}

/// After those of the independent states: what the states that follow have, and whose matrix has some.
void NodeSystem::find_others() const {
  for (Layer& layer : layers_) layer.has_others = false;
  for (const Interaction& interaction : interactions_)
    for (const std::size_t layer : interaction.layers)
      if (!interaction.is_of_roots && layer != kAtRest && layers_[layer].mapping && interaction.field->is_in_matrix())
        layers_[layer].has_others = true;
  for (std::size_t i = layers_.size(); i-- > 0;) {
    Layer& layer = layers_[i];
    if (layer.mapping) {
      layer.other_fields.clear();
      for (const scene::ForceField* field : layer.force_fields)
        if (field->is_in_matrix()) layer.other_fields.push_back(field);
    }
    layer.has_others = layer.has_others || !layer.other_fields.empty() || (layer.mapping && !layer.masses.empty());
    if (layer.has_others && layer.mapping) layers_[layer.above].has_others = true;
  }
}

bool NodeSystem::release(double time, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end, Points force,
                         Points product) {
  bool has_released = false;
  for (const Layer& root : roots())
    for (scene::ForceField* field : root.force_fields) {
      if (!field->is_one_sided()) continue;
      const bool pulled = ImplicitEuler::release_from(
          rows_of(root, force), difference_,
          [&](Points f) { field->add_force(time, rows_of(root, x), rows_of(root, v), f); },
          [&](double sign) { field->add_stiffness_product(sign, rows_of(root, v), rows_of(root, product)); },
          [&] { return field->release(rows_of(root, x_end), rows_of(root, v_end)); });
      has_released = has_released || pulled;
    }
  for (Interaction& interaction : interactions_) {
    scene::Interaction& field = *interaction.field;
    if (!field.is_one_sided()) continue;
    const bool pulled = ImplicitEuler::release_from(
        force, difference_,
        [&](Points f) {
          field.add_force(time, positions_of(interaction, x), velocities_of(interaction, v), forces_of(interaction, f));
        },
        [&](double sign) {
          field.add_stiffness_product(sign, increments_of(interaction, v), forces_of(interaction, product));
        },
        [&] { return field.release(positions_of(interaction, x_end), velocities_of(interaction, v_end)); });
    has_released = has_released || pulled;
  }
  return has_released;
}

void NodeSystem::prescribe(double time, Points x, Points v) const {
  for (const Constraint& constraint : constraints_) {
    const auto [first, second] = std::pair(constraint.layers[0], constraint.layers[1]);
    if (constraint.of_one) {
      constraint.of_one->project_motion(time, rows_of(root(first), x), rows_of(root(first), v));
    } else {
      scene::MechanicalState& followed = *layers_[first].state;
      const bool follows = layers_[first].mapping;
      constraint.of_two->project_motion(
          time, {follows ? Points(followed.positions()) : rows_of(root(first), x), rows_of(root(second), x)},
          {follows ? Points(followed.velocities()) : rows_of(root(first), v), rows_of(root(second), v)});
    }
  }
}

void NodeSystem::project(const Constraint& constraint, Points field) const {
  const auto [first, second] = std::pair(constraint.layers[0], constraint.layers[1]);
  if (constraint.of_one)
    constraint.of_one->project(rows_of(root(first), field));
  else
    constraint.of_two->project({part_of(first, field, &Layer::f), rows_of(root(second), field)});
}

void NodeSystem::project(Points field) const {
  for (const Constraint& constraint : constraints_) project(constraint, field);
}

void NodeSystem::pin(BlockMatrix& A) const {
  for (const Constraint& constraint : constraints_) {
    const Layer& layer = root(constraint.layers[1]);
    A.set_range(layer.first_node, layer.state->num_nodes());
    if (constraint.of_one)
      constraint.of_one->pin(A);
    else
      constraint.of_two->pin(A);
  }
  A.set_whole_range();
}

ConstPoints NodeSystem::rows_of_state(const scene::MechanicalState& state, ConstPoints of_all) const {
  const auto root = std::ranges::find(roots(), &state, &Layer::state);
  if (root == roots().end()) throw InputError("a state is asked for that the time integrator does not move");
  return rows_of(*root, of_all);
}

void NodeSystem::require_mass() const {
  std::vector<bool> has_mass(layers_.size());
  for (std::size_t i = layers_.size(); i-- > 0;) {
    has_mass[i] = has_mass[i] || !layers_[i].masses.empty();
    if (layers_[i].mapping && has_mass[i]) has_mass[layers_[i].above] = true;
    if (layers_[i].mapping || has_mass[i]) continue;
    scene::MechanicalState& state = *layers_[i].state;
    throw InputError(fmt::format("no mass on {} '{}' of its node and below", state.class_name(), state.name()));
  }
}

double NodeSystem::kinetic_energy() const {
  double energy = 0;
  for (const Layer& layer : layers_)
    for (const scene::Mass* mass : layer.masses) energy += mass->kinetic_energy(layer.state->velocities());
  return energy;
}

double NodeSystem::elastic_energy() const {
  double energy = 0;
  for (const Layer& layer : layers_)
    for (const scene::ForceField* field : layer.force_fields)
      if (const auto* potential = dynamic_cast<const scene::Potential*>(field); potential && field->body())
        energy += potential->potential_energy(node_.clock().time, layer.state->positions());
  return energy;
}

double NodeSystem::recovery_work() const {
  double work = 0;
  for (const Layer& layer : layers_)
    for (const scene::ForceField* field : layer.force_fields)
      if (const Body* body = field->body()) work += body->recovery_work(layer.state->positions());
  return work;
}

bool NodeSystem::damps_explicitly() const {
  return std::ranges::any_of(interactions_, [](const Interaction& one) { return one.field->damps_explicitly(); }) ||
         std::ranges::any_of(layers_, [](const Layer& layer) {
           return std::ranges::any_of(layer.force_fields, &scene::ForceField::damps_explicitly);
         });
}

void NodeSystem::damping_force(double time, ConstPoints x, ConstPoints v, Points f) {
  difference_.setZero(num_nodes_, 3);  // no velocity
  f.setZero();
  add_force(Over::kDampers, time, x, difference_, f);
  f = -f;
  add_force(Over::kDampers, time, x, v, f);
}

void NodeSystem::divide_by_mass(Points field) const {
  PointArray mass = PointArray::Zero(num_nodes_, 3);
  for (const Layer& root : roots())
    for (const scene::Mass* part : root.masses) part->add_diagonal(1, rows_of<Points>(root, mass));
  field = (mass.array() > 0).select(field.array() / mass.array(), 0).matrix();
}

scene::Component& NodeSystem::strongest_damper(double time) const {
  scene::Component* strongest = nullptr;
  double most = -1;
  const auto weigh = [&](scene::Component* component, std::array<scene::MechanicalState*, 2> states,
                         const auto& add_force) {
    OfTwo<PointArray> f(PointArray::Zero(states[0]->num_nodes(), 3), PointArray::Zero(states[1]->num_nodes(), 3));
    const OfTwo<PointArray> none = f;
    add_force(none, f);
    f = {-f.first, -f.second};
    add_force(OfTwo<PointArray>(states[0]->velocities(), states[1]->velocities()), f);
    const double size = f.first.squaredNorm() + f.second.squaredNorm();
    if (size > most) std::tie(strongest, most) = std::pair(component, size);
  };
  for (const Layer& layer : layers_)
    for (scene::ForceField* field : layer.force_fields)
      if (field->damps_explicitly())
        weigh(field, {layer.state, layer.state}, [&](const OfTwo<PointArray>& v, OfTwo<PointArray>& f) {
          field->add_force(time, layer.state->positions(), v.first, f.first);
        });
  for (const Interaction& interaction : interactions_) {
    const std::array<scene::MechanicalState*, 2> states = interaction.field->states();
    if (interaction.field->damps_explicitly())
      weigh(dynamic_cast<scene::Component*>(interaction.field), states,
            [&](const OfTwo<PointArray>& v, OfTwo<PointArray>& f) {
              interaction.field->add_force(time, {states[0]->positions(), states[1]->positions()}, {v.first, v.second},
                                           {f.first, f.second});
            });
  }
  return *strongest;
}

double NodeSystem::highest_frequency() const {
  double frequency = 0;
  for (const Layer& layer : layers_) {
    const double mass = scene::total_mass(layer.masses, *layer.state);
    for (const scene::ForceField* field : layer.force_fields)
      if (const Body* body = field->body())
        frequency = std::max(frequency, check_model(*body, mass, node_.clock().dt).highest_frequency);
  }
  return frequency;
}

void NodeSystem::project_motion(double time) const {
  for (const Constraint& constraint : constraints_) {
    scene::MechanicalState &first = *layers_[constraint.layers[0]].state,
                           &second = *layers_[constraint.layers[1]].state;
    if (constraint.of_one)
      constraint.of_one->project_motion(time, first.positions(), first.velocities());
    else
      constraint.of_two->project_motion(time, {first.positions(), second.positions()},
                                        {first.velocities(), second.velocities()});
  }
  follow();
}

void NodeSystem::follow() const {
  for (const Layer& layer : followers()) {
    scene::MechanicalState& above = *layers_[layer.above].state;
    layer.mapping->apply(above.positions(), layer.state->positions());
    layer.mapping->apply(above.velocities(), layer.state->velocities());
  }
}

}  // namespace hexaplast::components
