// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/shown_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "hexaplast/body.hpp"
#include "scene/interfaces.hpp"
#include "scene/region.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::view {
namespace {

/// Takes what a force field adds to the forces of a state [N].
using TakeLoad = std::function<void(const scene::ForceField&, const PointArray& forces)>;

/// Hands out what each load component of a state, or of one that follows it, adds to the state's forces.
void for_each_load(double time, const scene::Node& root, scene::MechanicalState& state, const TakeLoad& take) {
  const auto at_rest = [&] { return PointArray(PointArray::Zero(state.num_nodes(), 3)); };
  for (const scene::ForceField* field : root.all<scene::ForceField>()) {
    const auto* load = dynamic_cast<const scene::Load*>(field);
    if (!load || !scene::acts_on(*field, state)) continue;
    PointArray forces = at_rest();
    load->add_load(time, state.positions(), state.velocities(), forces);
    take(*field, forces);
  }
  for (const scene::Mapping* mapping : root.all<scene::Mapping>()) {
    if (!mapping->output() || mapping->input() != &state) continue;
    for_each_load(time, root, *mapping->output(), [&](const scene::ForceField& field, const PointArray& below) {
      PointArray forces = at_rest();
      mapping->add_transposed(below, forces);
      take(field, forces);
    });
  }
}

/// The body of the nearest node above that has one; null: there is none, or it is the only one.
const output::Bodies::Entry* carrier_of(const scene::VisualModel& model, const ShownScene& shown) {
  if (!shown.bodies || shown.bodies->is_one()) return nullptr;
  for (const scene::Node* node = &model.node(); node; node = node->parent())
    for (std::size_t i = 0; i < shown.scene_bodies.size(); ++i)
      if (&shown.scene_bodies[i].field->node() == node) return &shown.bodies->all()[i];
  return nullptr;
}

}  // namespace

std::vector<output::Bodies::Entry> entries_of(const std::vector<scene::SceneBody>& bodies) {
  std::vector<output::Bodies::Entry> entries;
  for (const scene::SceneBody& body : bodies) entries.push_back({.name = body.name, .body = body.field->body()});
  return entries;
}

std::string path_of(const scene::Component& component) {
  const std::string node = component.node().path();
  return (node == "/" ? "" : node.substr(1) + "/") + component.name();
}

PointArray free_directions(scene::Scene& scene, scene::MechanicalState& state) {
  NodeMask is_free = NodeMask::Ones(state.num_nodes(), 3);
  for (const scene::ProjectiveConstraint* constraint : scene.root().all<scene::ProjectiveConstraint>())
    if (scene::acts_on(*constraint, state)) constraint->fix(is_free);
  return is_free.cast<double>();
}

std::vector<int> fixed_nodes(const ShownScene& shown) {
  std::vector<int> fixed;
  for (std::size_t i = 0; i < shown.scene_bodies.size(); ++i) {
    const PointArray is_free = free_directions(shown.scene, *shown.scene_bodies[i].state);
    for (int node = 0; node < is_free.rows(); ++node)
      if (is_free.row(node).isZero(0)) fixed.push_back(shown.bodies->all()[i].first_node + node);
  }
  return fixed;
}

output::BoundaryConditions conditions_of(const ShownScene& shown) {
  const scene::Node& root = shown.scene.root();
  const double time = shown.scene.time();
  const std::vector all = root.all<scene::Instrument>();
  const Eigen::Index num_nodes = shown.bodies->mesh().num_nodes();
  output::BoundaryConditions conditions;
  conditions.fixed.assign(static_cast<std::size_t>(num_nodes), 0);
  for (const int node : fixed_nodes(shown)) conditions.fixed[static_cast<std::size_t>(node)] = 1;

  conditions.loads = PointArray::Zero(num_nodes, 3);
  const auto show = [&](const scene::Instrument& instrument) -> output::Instrument* {
    const std::optional<Vec3> place = instrument.place(time);
    if (!place) return nullptr;
    output::Instrument& seen = conditions.instruments.emplace_back();
    seen.id = static_cast<int>(std::ranges::find(all, &instrument) - all.begin());
    seen.place = *place;
    seen.shape_points = instrument.shape_points(time);
    seen.shape_triangles = instrument.shape_triangles();
    return &seen;
  };
  for (std::size_t i = 0; i < shown.scene_bodies.size(); ++i) {
    const output::Bodies::Entry& body = shown.bodies->all()[i];
    scene::MechanicalState& state = *shown.scene_bodies[i].state;
    for_each_load(shown.load_time, root, state, [&](const scene::ForceField& field, const PointArray& forces) {
      output::Bodies::rows(body, conditions.loads) += forces;
      const auto* instrument = dynamic_cast<const scene::Instrument*>(&field);
      output::Instrument* seen = instrument ? show(*instrument) : nullptr;
      if (!seen) return;
      std::vector<int> nodes;
      for (int node = 0; node < forces.rows(); ++node)
        if (!forces.row(node).isZero(0)) nodes.push_back(node);
      seen->forces = forces(nodes, Eigen::all);
      for (const int node : nodes) seen->nodes.push_back(body.first_node + node);
    });
  }
  for (const scene::Instrument* instrument : all)
    if (!dynamic_cast<const scene::ForceField*>(instrument)) show(*instrument);  // a blade presses on nothing
  for (const scene::ShowsSprings* springs : root.all<scene::ShowsSprings>())
    for (const scene::SpringLine& line : springs->spring_lines()) conditions.springs.push_back(line);
  return conditions;
}

output::Regions shown_regions(scene::Scene& scene, const output::Bodies& bodies) {
  output::Regions regions;
  for (scene::MaterialRegion* region : scene.root().all<scene::MaterialRegion>()) {
    regions.names.push_back(path_of(*region));
    const Body* body = region->field() ? region->field()->body() : nullptr;
    const auto owner = std::ranges::find(bodies.all(), body, &output::Bodies::Entry::body);
    if (owner == bodies.all().end()) continue;
    regions.of_hexahedra.resize(static_cast<std::size_t>(bodies.mesh().num_elements()), 0);
    for (const int hexahedron : region->hexahedra())
      regions.of_hexahedra[static_cast<std::size_t>(owner->first_hexahedron + hexahedron)] =
          static_cast<int>(regions.names.size());
  }
  if (regions.of_hexahedra.empty()) regions.names.clear();
  return regions;
}

std::string name_of(int hexahedron, std::span<const output::Bodies::Entry> bodies, const output::Regions& regions) {
  std::string text;
  int first = 0;
  for (const output::Bodies::Entry& body : bodies)
    if (body.first_hexahedron <= hexahedron) {
      text = body.name + ", ";
      first = body.first_hexahedron;
    }
  if (!regions.names.empty())
    if (const int region = regions.of_hexahedra[static_cast<std::size_t>(hexahedron)]; region > 0)
      text += regions.names[static_cast<std::size_t>(region - 1)] + ", ";
  return text + fmt::format("hexahedron {}", hexahedron - first);
}

output::Staging staging_of(const ShownScene& shown) {
  scene::Node& root = shown.scene.root();
  output::Staging staging;
  std::optional<bool> shows_embedded_surfaces, shows_hexahedra;
  if (const std::vector styles = root.all<scene::VisualStyle>(); !styles.empty()) {
    shows_embedded_surfaces = styles.front()->shows_visual_models();
    shows_hexahedra = styles.front()->shows_behaviour_models();
    staging.shows_loads = styles.front()->shows_loads();
  }
  for (const scene::VisualModel* model : root.all<scene::VisualModel>())
    if (model->is_carried() && model->points().rows() > 0 && shows_embedded_surfaces.value_or(true)) {
      staging.embedded_surfaces.push_back({model->points(), model->triangles(), model->quads()});
      if (const output::Bodies::Entry* carrier = carrier_of(*model, shown)) {
        staging.embedded_surfaces.back().first_hexahedron = carrier->first_hexahedron;
        staging.embedded_surfaces.back().num_hexahedra = carrier->body->mesh().num_elements();
      }
    }
  staging.shows_hexahedra = shows_hexahedra.value_or(staging.embedded_surfaces.empty());

  if (shown.bodies) staging.regions = shown_regions(shown.scene, *shown.bodies);
  staging.gravity = root.clock().gravity;
  staging.is_anatomical = std::ranges::any_of(root.all<scene::MayBeOfPatient>(),
                                              [](scene::MayBeOfPatient* mesh) { return mesh->is_of_patient(); });
  if (const std::vector cameras = root.all<scene::Camera>(); !cameras.empty())
    staging.viewpoint = cameras.front()->viewpoint();
  return staging;
}

}  // namespace hexaplast::view
