// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/staging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "runner/command.hpp"
#include "scene/region.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::runner {
namespace {

std::string path_of(const scene::Component& component) {
  const std::string node = component.node().path();
  return (node == "/" ? "" : node.substr(1) + "/") + component.name();
}

std::vector<double> numbers_of(const scene::Value& value) {
  if (const double* number = std::get_if<double>(&value)) return {*number};
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  return numbers ? *numbers : std::vector<double>();
}

std::optional<output::Viewpoint> viewpoint_of(const scene::Camera& camera) {
  const std::optional<scene::Viewpoint>& said = camera.viewpoint();
  if (!said) return std::nullopt;
  output::Viewpoint viewpoint{said->towards, said->up, {}};
  if (said->eye)
    viewpoint.eye = output::Viewpoint::Eye{said->eye->position, said->eye->looks_at, said->eye->field_of_view,
                                           said->eye->is_perspective};
  return viewpoint;
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

std::vector<RegionFigure> regions_of(scene::Scene& scene) {
  std::vector<RegionFigure> figures;
  for (scene::MaterialRegion* region : scene.root().all<scene::MaterialRegion>()) {
    RegionFigure& figure =
        figures.emplace_back(RegionFigure{.path = path_of(*region), .num_hexahedra = region->hexahedra().size()});
    for (const Row<Material>& row : material_rows()) {
      scene::Data* data = region->find_data(row.name);
      if (!data || !data->is_given()) continue;
      const std::vector<double> numbers = numbers_of(data->value());
      if (numbers.empty()) continue;
      const auto [min, max] = std::ranges::minmax(numbers);
      figure.values.push_back({row.name, row.unit, min, max});
    }
  }
  return figures;
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

std::string describe(const RegionFigure& region) {
  std::string text = fmt::format("{} {}", region.num_hexahedra, region.num_hexahedra == 1 ? "hexahedron" : "hexahedra");
  for (const RegionFigure::Value& value : region.values)
    text += fmt::format(", {} {}{}{}", value.name, min_to_max(value.min, value.max), value.unit.empty() ? "" : " ",
                        value.unit);
  return text;
}

std::string min_to_max(double min, double max) {
  return min == max ? fmt::format("{:.6g}", min) : fmt::format("{:.6g} to {:.6g}", min, max);
}

output::Staging staging_of(Simulation& simulation) {
  scene::Scene& scene = simulation.scene();
  scene::Node& root = scene.root();
  output::Staging staging;
  std::optional<bool> shows_embedded_surfaces, shows_hexahedra;
  if (const std::vector styles = root.all<scene::VisualStyle>(); !styles.empty()) {
    shows_embedded_surfaces = styles.front()->shows_visual_models();
    shows_hexahedra = styles.front()->shows_behaviour_models();
    staging.is_wireframe = styles.front()->shows_wireframe();
    staging.shows_loads = styles.front()->shows_loads();
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
