// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/staging.hpp"

#include <optional>

#include "runner/loads.hpp"
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

}  // namespace

output::Staging staging_of(Simulation& simulation) {
  scene::Scene& scene = simulation.scene();
  const scene::Node& root = scene.root();
  output::Staging staging;
  std::optional<bool> shows_skins, shows_hexahedra;
  if (const std::vector styles = root.all<scene::VisualStyle>(); !styles.empty()) {
    shows_skins = styles.front()->shows_visual_models();
    shows_hexahedra = styles.front()->shows_behaviour_models();
    staging.is_wireframe = styles.front()->shows_wireframe();
  }
  for (const scene::VisualModel* model : root.all<scene::VisualModel>())
    if (model->is_carried() && model->points().rows() > 0 && shows_skins.value_or(true))
      staging.skins.push_back({model->points(), model->triangles(), model->quads()});
  staging.shows_hexahedra = shows_hexahedra.value_or(staging.skins.empty());

  const PointArray directions = free_directions(scene, simulation.state());
  for (int n = 0; n < directions.rows(); ++n)
    if (directions.row(n).isZero(0)) staging.fixed_nodes.push_back(n);
  if (const std::vector cameras = root.all<scene::Camera>(); !cameras.empty())
    staging.viewpoint = viewpoint_of(*cameras.front());
  return staging;
}

}  // namespace hexaplast::runner
