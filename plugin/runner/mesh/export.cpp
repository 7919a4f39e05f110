// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/export.hpp"

#include <fmt/format.h>

#include "hexaplast/body.hpp"
#include "hexaplast/formats/whole_file.hpp"
#include "record/abaqus_deck.hpp"
#include "record/vtu.hpp"
#include "runner/run/loads.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {
namespace {

output::AbaqusDeck deck_of(scene::Scene& scene, const output::Bodies& bodies,
                           const std::vector<scene::MechanicalState*>& states, const MeshExportOptions& options) {
  output::AbaqusDeck deck;
  deck.title = options.scene.file.stem().string();
  scene::Component* settings = find_settings(scene);
  const long num_steps = settings && settings->is_given("steps") ? settings->integer("steps") : 1;
  deck.time = options.time ? *options.time : time_of_greatest_loads(scene, states, num_steps);
  deck.loads.resize(bodies.mesh().num_nodes(), 3);
  deck.is_free = deck.loads;
  for (std::size_t i = 0; i < states.size(); ++i) {
    output::Bodies::rows(bodies.all()[i], deck.loads) = loads_at(deck.time, scene, *states[i]);
    output::Bodies::rows(bodies.all()[i], deck.is_free) = free_directions(scene, *states[i]);
  }
  return deck;
}

/// Springs, ties, contact and whatever else makes forces, but for bodies and prescribed loads.
void warn_of_what_is_left_out(scene::Scene& scene) {
  scene.root().for_each<scene::Component>([](scene::Component& component) {
    const auto* field = dynamic_cast<const scene::ForceField*>(&component);
    const bool is_left_out = dynamic_cast<const scene::Interaction*>(&component) ||
                             dynamic_cast<const scene::InteractionProjectiveConstraint*>(&component) ||
                             (field && !field->body() && field->loaded_nodes().empty());
    if (is_left_out)
      component.remark(scene::Severity::kWarning, {},
                       fmt::format("'{}' is not in the deck, which has hexahedra, held nodes and prescribed loads",
                                   component.name()));
  });
  log_warnings(scene);
}

}  // namespace

void export_mesh(const MeshExportOptions& options) {
  SceneOptions scene_options = options.scene;
  scene_options.output.writes = false;
  scene::Scene scene = load_scene(scene_options);
  const std::filesystem::path out = output_place(options.out, scene.root().files().inputs);
  std::vector<output::Bodies::Entry> entries;
  for (const scene::SceneBody& body : scene::bodies_of(scene))
    entries.push_back({.name = body.name, .body = body.field->body()});
  if (entries.empty())
    throw scene::SceneError(
        scene::format_error(scene.root().place(), "no body in the scene: there is nothing to export"));
  const output::Bodies bodies(std::move(entries));
  const std::vector<scene::MechanicalState*> states = scene::shown_states(scene);

  if (options.format == "vtu") {
    PointArray x, v;
    const PointArray& positions = scene::positions_of(states, x);
    output::write_vtu(out, bodies, positions, scene::velocities_of(states, v), bodies.fields(positions));
  } else {
    warn_of_what_is_left_out(scene);
    output::write_abaqus_deck(out, bodies, deck_of(scene, bodies, states, options));
  }
}

}  // namespace hexaplast::runner
