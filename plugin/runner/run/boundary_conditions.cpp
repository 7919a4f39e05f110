// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/boundary_conditions.hpp"

#include <algorithm>

#include "hexaplast/geometry/sections.hpp"
#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::runner {

PointArray loads_at(double time, scene::Scene& scene, scene::MechanicalState& state) {
  const PointArray& rest = state.rest_positions();
  const PointArray at_rest = PointArray::Zero(rest.rows(), 3);
  PointArray loads = at_rest;
  for (const scene::Mass* mass : scene::masses_of(scene.root(), state))
    mass->add_gravity(scene.root().clock().gravity, loads);
  for (scene::ForceField* field : scene.root().all<scene::ForceField>())
    if (!field->body() && scene::acts_on(*field, state)) field->add_force(time, rest, at_rest, loads);
  for (const scene::Mapping* mapping : scene.root().all<scene::Mapping>())
    if (mapping->input() == &state) mapping->add_transposed(loads_at(time, scene, *mapping->output()), loads);
  return loads;
}

std::set<int> loaded_nodes(Simulation& simulation) {
  std::set<int> loaded;
  for (const scene::ForceField* field : simulation.scene().root().all<scene::ForceField>())
    for (std::size_t i = 0; i < simulation.scene_bodies().size(); ++i)
      if (scene::acts_on(*field, *simulation.scene_bodies()[i].state))
        for (const int node : field->loaded_nodes()) loaded.insert(simulation.bodies()->all()[i].first_node + node);
  return loaded;
}

bool measures_ends(Simulation& simulation) {
  const output::Bodies* bodies = simulation.bodies();
  if (!bodies) return false;
  if (simulation.end_sections() != "auto") return simulation.end_sections() == "yes";
  if (!bodies->is_one() || !simulation.scene().root().all<scene::Instrument>().empty()) return false;

  std::set<int> acted_on = loaded_nodes(simulation);
  for (const int node : view::fixed_nodes(simulation.shown())) acted_on.insert(node);
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
