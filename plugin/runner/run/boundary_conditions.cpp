// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/boundary_conditions.hpp"

#include <algorithm>
#include <functional>

#include "hexaplast/geometry/sections.hpp"
#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::runner {
namespace {

/// Takes what a force field adds to the forces of a state [N].
using TakeLoad = std::function<void(const scene::ForceField*, const PointArray& forces)>;

/// Hands out what each load component of a state, or of one that follows it, adds to the state's forces, and the
/// constant forces of the states as one more: take(null, forces).
void for_each_load(double time, const scene::Node& root, scene::MechanicalState& state, const TakeLoad& take) {
  const auto at_rest = [&] { return PointArray(PointArray::Zero(state.num_nodes(), 3)); };
  PointArray constant = at_rest();
  state.add_external_force(constant);
  take(nullptr, constant);
  for (const scene::ForceField* field : root.all<scene::ForceField>()) {
    const auto* load = dynamic_cast<const scene::Load*>(field);
    if (!load || !scene::acts_on(*field, state)) continue;
    PointArray forces = at_rest();
    load->add_load(time, state.positions(), state.velocities(), forces);
    take(field, forces);
  }
  for (const scene::Mapping* mapping : root.all<scene::Mapping>()) {
    if (!mapping->output() || mapping->input() != &state) continue;
    for_each_load(time, root, *mapping->output(), [&](const scene::ForceField* field, const PointArray& below) {
      PointArray forces = at_rest();
      mapping->add_transposed(below, forces);
      take(field, forces);
    });
  }
}

}  // namespace

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

output::BoundaryConditions conditions_of(Simulation& simulation) {
  const scene::Node& root = simulation.scene().root();
  const std::vector all = root.all<scene::Instrument>();
  const Eigen::Index num_nodes = simulation.bodies()->mesh().num_nodes();
  output::BoundaryConditions conditions;
  conditions.fixed.assign(static_cast<std::size_t>(num_nodes), 0);
  for (const int node : fixed_nodes(simulation)) conditions.fixed[static_cast<std::size_t>(node)] = 1;

  conditions.loads = PointArray::Zero(num_nodes, 3);
  const auto show = [&](const scene::Instrument& instrument) -> output::Instrument* {
    const std::optional<Vec3> place = instrument.place(simulation.time());
    if (!place) return nullptr;
    output::Instrument& shown = conditions.instruments.emplace_back();
    shown.id = static_cast<int>(std::ranges::find(all, &instrument) - all.begin());
    shown.place = *place;
    shown.shape_points = instrument.shape_points(simulation.time());
    shown.shape_triangles = instrument.shape_triangles();
    return &shown;
  };
  for (std::size_t i = 0; i < simulation.scene_bodies().size(); ++i) {
    const output::Bodies::Entry& body = simulation.bodies()->all()[i];
    scene::MechanicalState& state = *simulation.scene_bodies()[i].state;
    for_each_load(simulation.load_time(), root, state, [&](const scene::ForceField* field, const PointArray& forces) {
      output::Bodies::rows(body, conditions.loads) += forces;
      const auto* instrument = dynamic_cast<const scene::Instrument*>(field);
      output::Instrument* shown = instrument ? show(*instrument) : nullptr;
      if (!shown) return;
      std::vector<int> nodes;
      for (int node = 0; node < forces.rows(); ++node)
        if (!forces.row(node).isZero(0)) nodes.push_back(node);
      shown->forces = forces(nodes, Eigen::all);
      for (const int node : nodes) shown->nodes.push_back(body.first_node + node);
    });
  }
  for (const scene::Instrument* instrument : all)
    if (!dynamic_cast<const scene::ForceField*>(instrument)) show(*instrument);  // a blade presses on nothing
  for (const scene::ShowsSprings* springs : root.all<scene::ShowsSprings>())
    for (const auto& [from, to, is_slack] : springs->spring_lines()) conditions.springs.push_back({from, to, is_slack});
  return conditions;
}

std::set<int> loaded_nodes(Simulation& simulation) {
  std::set<int> loaded;
  for (const scene::ForceField* field : simulation.scene().root().all<scene::ForceField>())
    for (std::size_t i = 0; i < simulation.scene_bodies().size(); ++i)
      if (scene::acts_on(*field, *simulation.scene_bodies()[i].state))
        for (const int node : field->loaded_nodes()) loaded.insert(simulation.bodies()->all()[i].first_node + node);
  return loaded;
}

std::vector<int> fixed_nodes(Simulation& simulation) {
  std::vector<int> fixed;
  for (std::size_t i = 0; i < simulation.scene_bodies().size(); ++i) {
    const PointArray is_free = free_directions(simulation.scene(), *simulation.scene_bodies()[i].state);
    for (int node = 0; node < is_free.rows(); ++node)
      if (is_free.row(node).isZero(0)) fixed.push_back(simulation.bodies()->all()[i].first_node + node);
  }
  return fixed;
}

bool measures_ends(Simulation& simulation) {
  const output::Bodies* bodies = simulation.bodies();
  if (!bodies) return false;
  if (simulation.end_sections() != "auto") return simulation.end_sections() == "yes";
  if (!bodies->is_one() || !simulation.scene().root().all<scene::Instrument>().empty()) return false;

  std::set<int> acted_on = loaded_nodes(simulation);
  for (const int node : fixed_nodes(simulation)) acted_on.insert(node);
  const auto is_acted_on = [&](int node) { return acted_on.contains(node); };
  const EndSections ends = end_sections(bodies->mesh());
  if (std::ranges::none_of(ends.min, is_acted_on) || std::ranges::none_of(ends.max, is_acted_on)) return false;
  for (const std::vector<int>* end : {&ends.min, &ends.max})
    for (const int node : *end) acted_on.erase(node);
  for (const std::vector<int>& section : ends.layers)
    if (std::ranges::all_of(section, is_acted_on))
      for (const int node : section) acted_on.erase(node);
  return acted_on.empty();
}

}  // namespace hexaplast::runner
