// SPDX-License-Identifier: LGPL-2.1-or-later
#include "components/mechanical_system.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/model_check.hpp"
#include "scene/parts.hpp"
#include "scene/potential.hpp"

namespace hexaplast::components {

NodeSystem::NodeSystem(scene::Node& node) : node_(node) {
  for (scene::State* state : scene::independent_states(node)) {
    if (state->node().local<scene::State>() != state) state->reject("a second state in its node, must be one");
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
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    PointArray external = PointArray::Zero(layer.state->num_nodes(), 3);
    layer.state->add_external_force(external);
    layer.is_loaded = layer.is_loaded || !layer.masses.empty() || !layer.force_fields.empty() || !external.isZero(0);
    if (layer.is_loaded) layers_[layer.above].is_loaded = true;
  }
  for (scene::ProjectiveConstraint* constraint : node.all<scene::ProjectiveConstraint>()) {
    const auto constrained =
        std::ranges::find_if(layers_, [&](const Layer& layer) { return scene::acts_on(*constraint, *layer.state); });
    if (constrained == layers_.end() || constrained->mapping)
      constraint->reject("constrains a state that follows another one");
    constrained->constraints.push_back(constraint);
  }
  find_interactions();
}

// They may stand anywhere in the scene.
void NodeSystem::find_interactions() {
  for (scene::InteractionForceField* field : node_.root().all<scene::InteractionForceField>()) {
    Interaction interaction{.field = field};
    bool is_ours = true;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto at = std::ranges::find(roots(), field->states()[k], &Layer::state);
      is_ours = is_ours && at != roots().end();
      if (is_ours) interaction.roots[k] = static_cast<std::size_t>(at - roots().begin());
    }
    if (is_ours) interactions_.push_back(interaction);
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
    root.state->settle();
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
  layer.state->add_external_force(f);
  for (const scene::MassMatrix* mass : layer.masses) mass->add_gravity(node_.clock().gravity, f);
  for (scene::ForceField* field : layer.force_fields)
    if (over == Over::kAll || !field->body()) field->add_force(time, x, v, f);
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
    layer.mapping->apply_positions(part_of(layer.above, x, &Layer::x), layer.x);
    layer.mapping->apply(part_of(layer.above, v, &Layer::v), layer.v);
    layer.f.setZero();
    add_force(over, layer, time, layer.x, layer.v, layer.f);
  }
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    if (layer.is_loaded) layer.mapping->add_transposed(layer.f, part_of(layer.above, f, &Layer::f));
  }
  for (const Interaction& interaction : interactions_)
    interaction.field->add_force(time, rows_of(interaction, x), rows_of(interaction, v), rows_of(interaction, f));
}

// A mass damps by its own factor, a force field by its own: both through the damping factor b of m M + b B + k K.
// Factors of 0 are common where energies are measured, and a product of a body costs as much with them.
void NodeSystem::add_product(Over over, const Layer& layer, const OperatorFactors& factors, ConstPoints dx, Points df) {
  const auto add_masses = [&](const auto& masses) {
    for (const scene::MassMatrix* mass : masses)
      mass->add_product(factors.mass - factors.damping * mass->rayleigh_mass(), dx, df);
  };
  const auto add_fields = [&](const auto& fields) {
    for (const scene::ForceField* field : fields) {
      if (over == Over::kLoads && field->body()) continue;
      const double stiffness = factors.stiffness + factors.damping * field->rayleigh_stiffness();
      if (stiffness != 0) field->add_stiffness_product(stiffness, dx, df);
      if (factors.damping != 0) field->add_damping_product(factors.damping, dx, df);
    }
  };
  if (over == Over::kOthers) {
    add_masses(layer.other_masses);
    add_fields(layer.other_fields);
    return;
  }
  if (over == Over::kAll) add_masses(layer.masses);
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
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    if (takes_part(layer)) layer.mapping->add_transposed(layer.f, part_of(layer.above, df, &Layer::f));
  }
  add_interactions(factors, dx, df);
}

void NodeSystem::add_interactions(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  for (const Interaction& interaction : interactions_) {
    const scene::InteractionForceField* field = interaction.field;
    if (!field->is_in_matrix()) continue;
    const double stiffness = factors.stiffness + factors.damping * field->rayleigh_stiffness();
    if (stiffness != 0) field->add_stiffness_product(stiffness, rows_of(interaction, dx), rows_of(interaction, df));
    if (factors.damping != 0)
      field->add_damping_product(factors.damping, rows_of(interaction, dx), rows_of(interaction, df));
  }
}

void NodeSystem::add_blocks(const Layer& layer, const OperatorFactors& factors, BlockMatrix& A) {
  for (const scene::MassMatrix* mass : layer.masses)
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
    const scene::InteractionForceField* field = interaction.field;
    const std::array first_nodes = {root(interaction.roots[0]).first_node, root(interaction.roots[1]).first_node};
    field->add_stiffness_blocks(factors.stiffness + factors.damping * field->rayleigh_stiffness(), A, first_nodes);
    field->add_damping_blocks(factors.damping, A, first_nodes);
  }
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
  layer.other_masses.clear();
  layer.other_fields.clear();
  for (const scene::MassMatrix* mass : layer.masses)
    if (!mass->add_diagonal(factors.mass - factors.damping * mass->rayleigh_mass(), system.diagonal))
      layer.other_masses.push_back(mass);
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
  for (std::size_t i = layers_.size(); i-- > 0;) {
    Layer& layer = layers_[i];
    if (layer.mapping) {
      layer.other_masses.assign(layer.masses.begin(), layer.masses.end());
      layer.other_fields.clear();
      for (const scene::ForceField* field : layer.force_fields)
        if (field->is_in_matrix()) layer.other_fields.push_back(field);
    }
    layer.has_others = layer.has_others || !layer.other_masses.empty() || !layer.other_fields.empty();
    if (layer.has_others && layer.mapping) layers_[layer.above].has_others = true;
  }
}

bool NodeSystem::release(double time, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end, Points force,
                         Points product) {
  bool has_released = false;
  for (const Layer& root : roots())
    for (scene::ForceField* field : root.force_fields) {
      if (!field->is_one_sided()) continue;
      const auto add = [&](double sign) {
        difference_.setZero(root.state->num_nodes(), 3);
        field->add_force(time, rows_of(root, x), rows_of(root, v), difference_);
        rows_of(root, force) += sign * difference_;
        field->add_stiffness_product(sign, rows_of(root, v), rows_of(root, product));
      };
      add(-1);
      has_released = field->release(rows_of(root, x_end), rows_of(root, v_end)) || has_released;
      add(1);
    }
  for (const Interaction& interaction : interactions_) {
    const auto add = [&](double sign) {
      difference_.setZero(num_nodes_, 3);
      interaction.field->add_force(time, rows_of(interaction, x), rows_of(interaction, v),
                                   rows_of(interaction, Points(difference_)));
      force += sign * difference_;
      interaction.field->add_stiffness_product(sign, rows_of(interaction, v), rows_of(interaction, product));
    };
    add(-1);
    has_released = interaction.field->release(rows_of(interaction, x_end), rows_of(interaction, v_end)) || has_released;
    add(1);
  }
  return has_released;
}

bool NodeSystem::add_mass_diagonal(Points diagonal) const {
  for (const Layer& layer : layers_)
    for (const scene::MassMatrix* mass : layer.masses)
      if (layer.mapping || !mass->add_diagonal(1, rows_of(layer, diagonal))) return false;
  return true;
}

void NodeSystem::prescribe(double time, Points x, Points v) const {
  for (const Layer& root : roots())
    for (const scene::ProjectiveConstraint* constraint : root.constraints)
      constraint->project_motion(time, rows_of(root, x), rows_of(root, v));
}

void NodeSystem::project(Points field) const {
  for (const Layer& root : roots())
    for (const scene::ProjectiveConstraint* constraint : root.constraints) constraint->project(rows_of(root, field));
}

void NodeSystem::pin(BlockMatrix& A) const {
  for (const Layer& root : roots()) {
    A.set_range(root.first_node, root.state->num_nodes());
    for (const scene::ProjectiveConstraint* constraint : root.constraints) constraint->pin(A);
  }
  A.set_whole_range();
}

ConstPoints NodeSystem::rows_of_state(const scene::State& state, ConstPoints of_all) const {
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
    scene::State& state = *layers_[i].state;
    if (!node_.is_read_as_sofa())
      throw InputError(fmt::format("no mass on {} '{}' of its node and below", state.class_name(), state.name()));
    state.remark(scene::Severity::kWarning, {}, "no mass on it: moves without inertia and weight, as in SOFA");
  }
}

void NodeSystem::require_points() const {
  for (const Layer& root : roots())
    if (!root.state->orientations().empty())
      throw InputError(
          fmt::format("the frames of MechanicalObject '{}' need an EulerImplicitSolver or an explicit "
                      "integrator",
                      root.state->name()));
}

double NodeSystem::kinetic_energy() const {
  double energy = 0;
  for (const Layer& layer : layers_)
    for (const scene::MassMatrix* mass : layer.masses) energy += mass->kinetic_energy(layer.state->velocities());
  return energy;
}

bool NodeSystem::has_elastic_energy() const {
  return std::ranges::all_of(layers_, [](const Layer& layer) {
    return std::ranges::all_of(layer.force_fields, [](const scene::ForceField* field) {
      return !field->body() || dynamic_cast<const scene::Potential*>(field);
    });
  });
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

double NodeSystem::highest_frequency() const {
  double frequency = 0;
  for (const Layer& layer : layers_) {
    const double mass = scene::total_mass(layer.masses, *layer.state);
    PointArray diagonal = PointArray::Zero(layer.state->num_nodes(), 3);
    double ModelCheck::*highest = &ModelCheck::highest_frequency;
    for (const scene::MassMatrix* part : layer.masses)
      if (!part->add_diagonal(0, diagonal)) highest = &ModelCheck::highest_frequency_consistent;
    for (const scene::ForceField* field : layer.force_fields)
      if (const Body* body = field->body())
        frequency = std::max(frequency, check_model(*body, mass, node_.clock().dt).*highest);
  }
  return frequency;
}

void NodeSystem::project_motion(double time) const {
  for (const Layer& root : roots())
    for (const scene::ProjectiveConstraint* constraint : root.constraints)
      constraint->project_motion(time, root.state->positions(), root.state->velocities());
  for (const Layer& root : roots()) root.state->settle();
  follow();
}

void NodeSystem::follow() const {
  for (const Layer& layer : followers()) {
    scene::State& above = *layers_[layer.above].state;
    layer.mapping->apply_positions(above.positions(), layer.state->positions());
    layer.mapping->apply(above.velocities(), layer.state->velocities());
  }
}

}  // namespace hexaplast::components
