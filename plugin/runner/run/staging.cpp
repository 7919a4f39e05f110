// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/staging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "runner/exit_code.hpp"
#include "runner/run/regions.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::runner {

namespace {

std::optional<output::Viewpoint> viewpoint_of(const scene::Camera& camera) {
  const std::optional<scene::Viewpoint>& said = camera.viewpoint();
  if (!said) return std::nullopt;
  output::Viewpoint viewpoint{said->towards, said->up, {}};
  if (said->eye)
    viewpoint.eye = output::Viewpoint::Eye{said->eye->position, said->eye->looks_at, said->eye->field_of_view,
                                           said->eye->is_perspective};
  return viewpoint;
}

/// Whether arrows are wanted: of the words about force fields the last one counts.
bool shows_loads(scene::VisualStyle& style) {
  bool is_shown = true;
  for (const std::string_view flag : scene::split_words(style.text("displayFlags"))) {
    if (flag == "showForceFields" || flag == "showBehavior" || flag == "showAll") is_shown = true;
    if (flag == "hideForceFields" || flag == "hideBehavior" || flag == "hideAll") is_shown = false;
  }
  return is_shown;
}

/// The body of the nearest node above that has one; null: there is none, or it is the only one.
const output::Bodies::Entry* carrier_of(const scene::VisualModel& model, Simulation& simulation) {
  if (!simulation.bodies() || simulation.bodies()->is_one()) return nullptr;
  for (const scene::Node* node = &model.node(); node; node = node->parent())
    for (std::size_t i = 0; i < simulation.scene_bodies().size(); ++i)
      if (&simulation.scene_bodies()[i].field->node() == node) return &simulation.bodies()->all()[i];
  return nullptr;
}

}  // namespace

output::Staging staging_of(Simulation& simulation) {
  scene::Scene& scene = simulation.scene();
  scene::Node& root = scene.root();
  output::Staging staging;
  std::optional<bool> shows_embedded_surfaces, shows_hexahedra;
  if (const std::vector styles = root.all<scene::VisualStyle>(); !styles.empty()) {
    shows_embedded_surfaces = styles.front()->shows_visual_models();
    shows_hexahedra = styles.front()->shows_behaviour_models();
    staging.is_wireframe = styles.front()->shows_wireframe();
    staging.shows_loads = shows_loads(*styles.front());
  }
  for (const scene::VisualModel* model : root.all<scene::VisualModel>())
    if (model->is_carried() && model->points().rows() > 0 && shows_embedded_surfaces.value_or(true)) {
      staging.embedded_surfaces.push_back({model->points(), model->triangles(), model->quads()});
      if (const output::Bodies::Entry* carrier = carrier_of(*model, simulation)) {
        staging.embedded_surfaces.back().first_hexahedron = carrier->first_hexahedron;
        staging.embedded_surfaces.back().num_hexahedra = carrier->body->mesh().num_elements();
      }
    }
  staging.shows_hexahedra = shows_hexahedra.value_or(staging.embedded_surfaces.empty());

  if (simulation.bodies()) staging.regions = shown_regions(scene, *simulation.bodies());
  staging.gravity = root.clock().gravity;
  staging.is_anatomical = std::ranges::any_of(root.all<scene::MayBeOfPatient>(),
                                              [](scene::MayBeOfPatient* mesh) { return mesh->is_of_patient(); });
  if (const std::vector cameras = root.all<scene::Camera>(); !cameras.empty())
    staging.viewpoint = viewpoint_of(*cameras.front());
  return staging;
}

void stage(const PictureOptions& options, output::Staging& staging) {
  if (!options.field.empty() || !options.regions.empty())
    staging.quantity = output::quantity_of(options.field).value_or(output::Quantity::kRegion);
  if (!options.up.empty()) staging.up = (options.up.front() == '-' ? -1 : 1) * Vec3::Unit(options.up.back() - 'x');
  for (const std::string& word : options.regions) {
    const std::vector<std::string>& names = staging.regions.names;
    staging.shown_regions.push_back(staging.regions.number_of(word));
    if (staging.shown_regions.back() == 0)
      throw UsageError(
          fmt::format("--region {}: {}", word,
                      names.empty() ? "there are no regions" : fmt::format("must be {}", fmt::join(names, " or "))));
  }
}

output::PictureRecord record_of(const output::Staging& staging) {
  return {.shows_hexahedra = staging.shows_hexahedra,
          .is_wireframe = staging.is_wireframe,
          .shows_loads = staging.shows_loads,
          .viewpoint = staging.viewpoint,
          .gravity = staging.gravity,
          .is_anatomical = staging.is_anatomical,
          .up = staging.up};
}

void restore(const output::PictureRecord& record, output::Staging& staging) {
  staging.shows_hexahedra = record.shows_hexahedra;
  staging.is_wireframe = record.is_wireframe;
  staging.shows_loads = record.shows_loads;
  staging.viewpoint = record.viewpoint;
  staging.gravity = record.gravity;
  staging.is_anatomical = record.is_anatomical;
  staging.up = record.up;
}

}  // namespace hexaplast::runner
