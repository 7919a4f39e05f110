// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/layered_system.hpp"

#include <algorithm>
#include <utility>

#include "base/require.hpp"

namespace hexaplast {
namespace {

/// Factor of a stiffness: each force field damps by its own Rayleigh factor, through the damping factor b of m M + b B
/// + k K. Masses likewise.
template <class Forces>
double stiffness_factor(const OperatorFactors& factors, const Forces& forces) {
  return factors.stiffness + factors.damping * forces.rayleigh_stiffness();
}
double mass_factor(const OperatorFactors& factors, const NodalMass& mass) {
  return factors.mass - factors.damping * mass.rayleigh_mass();
}

}  // namespace

std::size_t LayeredSystem::add_state(NodalState& state) {
  layers_.push_back({.state = &state, .first_node = num_nodes_});
  num_nodes_ += state.num_nodes();
  return num_roots_++;
}

std::size_t LayeredSystem::add_state(NodalState& state, const NodalMapping& mapping, std::size_t above) {
  const PointArray none = PointArray::Zero(state.num_nodes(), 3);
  layers_.push_back({.state = &state, .mapping = &mapping, .above = above, .x = none, .v = none, .f = none});
  return layers_.size() - 1;
}

void LayeredSystem::add_interaction(PairForces& forces, std::array<NodalState*, 2> states) {
  Interaction interaction{.forces = &forces, .states = states};
  for (std::size_t end = 0; end < 2; ++end) {
    const std::size_t layer = interaction.layers[end] = layer_of(states[end]);
    if (layer == kAtRest) {
      interaction.zero = interaction.scratch = PointArray::Zero(states[end]->num_nodes(), 3);
    } else if (layers_[layer].mapping) {
      layers_[layer].is_loaded = true;
      interaction.is_of_roots = false;
    }
  }
  interactions_.push_back(std::move(interaction));
}

void LayeredSystem::find_loaded() {
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    layer.is_loaded = layer.is_loaded || !layer.masses.empty() || !layer.forces.empty();
    if (layer.is_loaded) layers_[layer.above].is_loaded = true;
  }
}

std::size_t LayeredSystem::layer_of(const NodalState* state) const {
  const auto found = std::ranges::find(layers_, state, &Layer::state);
  return found == layers_.end() ? kAtRest : static_cast<std::size_t>(found - layers_.begin());
}

// ------------------------------------------------------------------------------------------------------------- motion

void LayeredSystem::gather() {
  x_.resize(num_nodes_, 3);
  v_.resize(num_nodes_, 3);
  for (const Layer& root : roots()) {
    rows_of<Points>(root, x_) = root.state->positions();
    rows_of<Points>(root, v_) = root.state->velocities();
  }
}

void LayeredSystem::scatter() const {
  for (const Layer& root : roots()) {
    root.state->positions() = rows_of<ConstPoints>(root, x_);
    root.state->velocities() = rows_of<ConstPoints>(root, v_);
  }
}

const PointArray& LayeredSystem::positions() {
  if (num_roots_ == 1) return layers_[0].state->positions();
  gather();
  return x_;
}

const PointArray& LayeredSystem::velocities() {
  if (num_roots_ == 1) return layers_[0].state->velocities();
  gather();
  return v_;
}

void LayeredSystem::follow() const {
  for (const Layer& layer : followers()) {
    NodalState& above = *layers_[layer.above].state;
    layer.mapping->apply(above.positions(), layer.state->positions());
    layer.mapping->apply(above.velocities(), layer.state->velocities());
  }
}

double LayeredSystem::kinetic_energy() const {
  double energy = 0;
  for (const Layer& layer : layers_)
    for (const NodalMass* mass : layer.masses) energy += mass->kinetic_energy(layer.state->velocities());
  return energy;
}

// ------------------------------------------------------------------------------------------------------------- forces

Pair<ConstPoints> LayeredSystem::positions_of(const Interaction& interaction, ConstPoints x) const {
  const auto of = [&](int end) {
    return part_of<ConstPoints>(interaction, end, x, &Layer::x, interaction.states[end]->positions());
  };
  return {of(0), of(1)};
}

Pair<ConstPoints> LayeredSystem::velocities_of(const Interaction& interaction, ConstPoints v) const {
  const auto of = [&](int end) {
    return part_of<ConstPoints>(interaction, end, v, &Layer::v, interaction.states[end]->velocities());
  };
  return {of(0), of(1)};
}

Pair<ConstPoints> LayeredSystem::increments_of(const Interaction& interaction, ConstPoints dx) const {
  const auto of = [&](int end) { return part_of<ConstPoints>(interaction, end, dx, &Layer::x, interaction.zero); };
  return {of(0), of(1)};
}

Pair<Points> LayeredSystem::forces_of(Interaction& interaction, Points f) const {
  interaction.scratch.setZero();
  const auto of = [&](int end) { return part_of<Points>(interaction, end, f, &Layer::f, interaction.scratch); };
  return {of(0), of(1)};
}

// What is between states that follow comes before they are carried up.
template <class TakesPart, class Add, class AddBetween>
void LayeredSystem::sum(const TakesPart& takes_part, std::initializer_list<Down> down, Points up, const Add& add,
                        const AddBetween& add_between) const {
  for (const Layer& root : roots()) add(root);
  for (Layer& layer : followers()) {
    if (!takes_part(layer)) continue;
    for (const auto& [of_all, scratch] : down)
      layer.mapping->apply(part_of(layers_[layer.above], of_all, scratch), layer.*scratch);
    layer.f.setZero();
    add(layer);
  }
  for (Interaction& interaction : interactions_)
    if (!interaction.is_of_roots) add_between(interaction);
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    const Layer& layer = layers_[i];
    if (takes_part(layer)) layer.mapping->add_transposed(layer.f, part_of(layers_[layer.above], up, &Layer::f));
  }
  for (Interaction& interaction : interactions_)
    if (interaction.is_of_roots) add_between(interaction);
}

void LayeredSystem::set_time_step(double dt) {
  for (Layer& layer : layers_)
    for (NodalForces* forces : layer.forces) forces->set_time_step(dt);
}

void LayeredSystem::compute_force(double time, ConstPoints x, ConstPoints v, Points f) {
  require_rows("LayeredSystem::compute_force", "x", x, num_nodes_);
  require_rows("LayeredSystem::compute_force", "f", f, num_nodes_);
  f.setZero();
  add_force(Over::kAll, time, x, v, f);
}

void LayeredSystem::add_load(double time, ConstPoints x, ConstPoints v, Points f) {
  add_force(Over::kLoads, time, x, v, f);
}

void LayeredSystem::add_force(Over over, double time, ConstPoints x, ConstPoints v, Points f) const {
  sum([](const Layer& layer) { return layer.is_loaded; }, {{x, &Layer::x}, {v, &Layer::v}}, f,
      [&](const Layer& layer) {
        const ConstPoints own_x = part_of(layer, x, &Layer::x), own_v = part_of(layer, v, &Layer::v);
        Points own_f = part_of(layer, f, &Layer::f);
        for (const NodalMass* mass : layer.masses) mass->add_gravity(gravity_, own_f);
        for (NodalForces* forces : layer.forces)
          if (over == Over::kAll || !forces->is_body()) forces->add_force(time, own_x, own_v, own_f);
      },
      [&](Interaction& interaction) {
        interaction.forces->add_force(time, positions_of(interaction, x), velocities_of(interaction, v),
                                      forces_of(interaction, f));
      });
}

bool LayeredSystem::release(double time, ConstPoints x, ConstPoints v, ConstPoints x_end, ConstPoints v_end,
                            Points force, Points product) {
  bool has_released = false;
  for (const Layer& root : roots())
    for (NodalForces* forces : root.forces) {
      if (!forces->is_one_sided()) continue;
      const bool pulled = ImplicitEuler::release_from(
          rows_of(root, force), difference_,
          [&](Points f) { forces->add_force(time, rows_of(root, x), rows_of(root, v), f); },
          [&](double sign) { forces->add_stiffness_product(sign, rows_of(root, v), rows_of(root, product)); },
          [&] { return forces->release(rows_of(root, x_end), rows_of(root, v_end)); });
      has_released = has_released || pulled;
    }
  for (Interaction& each : interactions_) {
    if (!each.forces->is_one_sided()) continue;
    const bool pulled = ImplicitEuler::release_from(
        force, difference_,
        [&](Points f) {
          each.forces->add_force(time, positions_of(each, x), velocities_of(each, v), forces_of(each, f));
        },
        [&](double sign) {
          each.forces->add_stiffness_product(sign, increments_of(each, v), forces_of(each, product));
        },
        [&] { return each.forces->release(positions_of(each, x_end), velocities_of(each, v_end)); });
    has_released = has_released || pulled;
  }
  return has_released;
}

// ----------------------------------------------------------------------------------------------------------- products

void LayeredSystem::add_product(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  require_rows("LayeredSystem::add_product", "dx", dx, num_nodes_);
  require_rows("LayeredSystem::add_product", "df", df, num_nodes_);
  add_product(Over::kAll, factors, dx, df);
}

void LayeredSystem::add_load_product(const OperatorFactors& factors, ConstPoints dx, Points df) const {
  add_product(Over::kLoads, factors, dx, df);
}

void LayeredSystem::Others::add_product(double factor, ConstPoints p, Points Fp) const {
  system_->add_product(Over::kOthers, times(factor), p, Fp);
}
void LayeredSystem::Others::add_blocks(double factor, BlockMatrix& A) const {
  system_->add_blocks(Over::kOthers, times(factor), A);
}

// Factors of 0 are common where energies are measured, and a product of a body costs as much with them.
void LayeredSystem::add_product(Over over, const OperatorFactors& factors, ConstPoints dx, Points df) const {
  sum([&](const Layer& layer) { return over == Over::kOthers ? layer.has_others : layer.is_loaded; }, {{dx, &Layer::x}},
      df,
      [&](const Layer& layer) {
        const ConstPoints own_dx = part_of(layer, dx, &Layer::x);
        Points own_df = part_of(layer, df, &Layer::f);
        if (over == Over::kAll || (over == Over::kOthers && layer.mapping))
          for (const NodalMass* mass : layer.masses) mass->add_product(mass_factor(factors, *mass), own_dx, own_df);
        const auto add = [&](const NodalForces& forces) {
          if (over == Over::kLoads && forces.is_body()) return;
          const double stiffness = stiffness_factor(factors, forces);
          if (stiffness != 0) forces.add_stiffness_product(stiffness, own_dx, own_df);
          if (factors.damping != 0) forces.add_damping_product(factors.damping, own_dx, own_df);
        };
        if (over == Over::kOthers)
          for (const NodalForces* forces : layer.others) add(*forces);
        else
          for (const NodalForces* forces : layer.forces) add(*forces);
      },
      [&](Interaction& interaction) {
        const PairForces& forces = *interaction.forces;
        if (!forces.is_in_matrix() || (over == Over::kOthers && interaction.is_in_diagonal)) return;
        const double stiffness = stiffness_factor(factors, forces);
        if (stiffness != 0)
          forces.add_stiffness_product(stiffness, increments_of(interaction, dx), forces_of(interaction, df));
        if (factors.damping != 0)
          forces.add_damping_product(factors.damping, increments_of(interaction, dx), forces_of(interaction, df));
      });
}

void LayeredSystem::add_blocks(Over over, const Layer& layer, const OperatorFactors& factors, BlockMatrix& A) {
  if (over == Over::kAll || layer.mapping)
    for (const NodalMass* mass : layer.masses) mass->add_blocks(mass_factor(factors, *mass), A);
  const auto add = [&](const NodalForces& forces) {
    forces.add_stiffness_blocks(stiffness_factor(factors, forces), A);
    forces.add_damping_blocks(factors.damping, A);
  };
  if (over == Over::kOthers)
    for (const NodalForces* forces : layer.others) add(*forces);
  else
    for (const NodalForces* forces : layer.forces) add(*forces);
}

void LayeredSystem::add_blocks(const OperatorFactors& factors, BlockMatrix& A) const {
  add_blocks(Over::kAll, factors, A);
}

void LayeredSystem::add_blocks(Over over, const OperatorFactors& factors, BlockMatrix& A) const {
  const auto takes_part = [&](const Layer& layer) {
    return over == Over::kOthers ? layer.has_others : layer.is_loaded;
  };
  for (const Layer& root : roots()) {
    A.set_range(root.first_node, root.state->num_nodes());
    add_blocks(over, root, factors, A);
  }
  for (Layer& layer : followers()) {
    if (!takes_part(layer)) continue;
    if (layer.blocks.num_nodes() == 0) layer.blocks = BlockMatrix(layer.state->num_nodes());
    layer.blocks.clear();
    add_blocks(over, layer, factors, layer.blocks);
  }
  for (std::size_t i = layers_.size(); i-- > num_roots_;) {
    Layer& layer = layers_[i];
    if (!takes_part(layer)) continue;
    layer.blocks.drop_unused();
    Layer& above = layers_[layer.above];
    if (!above.mapping) A.set_range(above.first_node, above.state->num_nodes());
    layer.mapping->add_transposed_blocks(layer.blocks, above.mapping ? above.blocks : A);
  }
  A.set_whole_range();
  for (const Interaction& interaction : interactions_) {
    const PairForces& forces = *interaction.forces;
    if (over == Over::kOthers && (!forces.is_in_matrix() || interaction.is_in_diagonal)) continue;
    std::array<int, 2> first_nodes = {};
    for (std::size_t end = 0; end < 2; ++end)
      first_nodes[end] = interaction.layers[end] == kAtRest ? -1 : layers_[interaction.layers[end]].first_node;
    forces.add_stiffness_blocks(stiffness_factor(factors, forces), A, first_nodes);
    forces.add_damping_blocks(factors.damping, A, first_nodes);
  }
}

bool LayeredSystem::add_operator(const OperatorFactors& factors, MatrixFreeSystem& system) const {
  if (num_roots_ == 1) {
    add_operator(layers_[0], factors, system);
  } else {
    for (Layer& root : roots()) {
      root.part.clear();
      root.part.wants_levels = system.wants_levels;
      root.part.diagonal.setZero(root.state->num_nodes(), 3);
      add_operator(root, factors, root.part);
      system.add_part(root.part, root.first_node);
    }
  }
  find_others();
  others_.factors = factors;
  bool interact = false;
  for (Interaction& interaction : interactions_) {
    const PairForces& forces = *interaction.forces;
    if (!forces.is_in_matrix()) continue;
    const auto [first, second] = interaction.layers;
    interaction.is_in_diagonal = first == second && interaction.is_of_roots;
    if (interaction.is_in_diagonal) {
      const Points diagonal = rows_of<Points>(layers_[first], system.diagonal);
      interaction.is_in_diagonal = forces.add_stiffness_diagonal(stiffness_factor(factors, forces), diagonal);
      if (interaction.is_in_diagonal) forces.add_damping_diagonal(factors.damping, diagonal);
    }
    interact = interact || !interaction.is_in_diagonal;
  }
  if (interact || std::ranges::any_of(roots(), &Layer::has_others)) system.others.emplace_back(&others_);
  return true;
}

/// What the kernels know of what acts on an independent state; it keeps what they do not.
void LayeredSystem::add_operator(Layer& layer, const OperatorFactors& factors, MatrixFreeSystem& system) const {
  layer.others.clear();
  for (const NodalMass* mass : layer.masses) mass->add_diagonal(mass_factor(factors, *mass), system.diagonal);
  for (const NodalForces* forces : layer.forces) {
    if (!forces->is_in_matrix()) continue;
    if (forces->add_operator(stiffness_factor(factors, *forces), system))
      forces->add_damping_diagonal(factors.damping, system.diagonal);
    else
      layer.others.push_back(forces);
  }
}

/// After those of the independent states: what the states that follow have, and whose matrix has some.
void LayeredSystem::find_others() const {
  for (Layer& layer : layers_) layer.has_others = false;
  for (const Interaction& interaction : interactions_)
    for (const std::size_t layer : interaction.layers)
      if (!interaction.is_of_roots && layer != kAtRest && layers_[layer].mapping && interaction.forces->is_in_matrix())
        layers_[layer].has_others = true;
  for (std::size_t i = layers_.size(); i-- > 0;) {
    Layer& layer = layers_[i];
    if (layer.mapping) {
      layer.others.clear();
      for (const NodalForces* forces : layer.forces)
        if (forces->is_in_matrix()) layer.others.push_back(forces);
    }
    layer.has_others = layer.has_others || !layer.others.empty() || (layer.mapping && !layer.masses.empty());
    if (layer.has_others && layer.mapping) layers_[layer.above].has_others = true;
  }
}

// -------------------------------------------------------------------------------------------------------- constraints

void LayeredSystem::prescribe(double time, Points x, Points v) const {
  for (const Constraint& constraint : constraints_) {
    const Layer &first = layers_[constraint.layers[0]], &second = layers_[constraint.layers[1]];
    if (constraint.of_one)
      constraint.of_one->project_motion(time, rows_of(first, x), rows_of(first, v));
    else
      constraint.of_two->project_motion(
          time, {first.mapping ? Points(first.state->positions()) : rows_of(first, x), rows_of(second, x)},
          {first.mapping ? Points(first.state->velocities()) : rows_of(first, v), rows_of(second, v)});
  }
}

void LayeredSystem::project_motion(double time) const {
  for (const Constraint& constraint : constraints_) {
    NodalState &first = *layers_[constraint.layers[0]].state, &second = *layers_[constraint.layers[1]].state;
    if (constraint.of_one)
      constraint.of_one->project_motion(time, first.positions(), first.velocities());
    else
      constraint.of_two->project_motion(time, {first.positions(), second.positions()},
                                        {first.velocities(), second.velocities()});
  }
  follow();
}

void LayeredSystem::constrain(Constraints& constraints) const {
  for (const Constraint& constraint : constraints_) {
    if (!constraint.couples()) {
      fix(constraint, constraints.free);
      continue;
    }
    constraints.projector = this;
    constraints.ties.push_back({layers_[constraint.layers[0]].first_node, layers_[constraint.layers[1]].first_node});
  }
}

void LayeredSystem::fix(const Constraint& constraint, NodeMask& free) const {
  const Layer& layer = layers_[constraint.layers[1]];
  const NodeMaskRows rows = free.middleRows(layer.first_node, layer.state->num_nodes());
  if (constraint.of_one)
    constraint.of_one->fix(rows);
  else
    constraint.of_two->fix(rows);
}

void LayeredSystem::project(const Constraint& constraint, Points field) const {
  if (constraint.couples()) {
    const Layer &first = layers_[constraint.layers[0]], &second = layers_[constraint.layers[1]];
    constraint.of_two->project({rows_of(first, field), rows_of(second, field)});
  } else {
    Constraints fixed;
    fixed.reset(num_nodes_);
    fix(constraint, fixed.free);
    fixed.project(field);
  }
}

void LayeredSystem::project(Points field) const {
  for (const Constraint& constraint : constraints_)
    if (constraint.couples()) project(constraint, field);
}

}  // namespace hexaplast
