// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/export.hpp"

#include "hexaplast/body.hpp"
#include "hexaplast/formats/whole_file.hpp"
#include "record/abaqus_deck.hpp"
#include "record/vtu.hpp"
#include "runner/run/loads.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {
namespace {

output::AbaqusDeck deck_of(scene::Scene& scene, const MeshExportOptions& options) {
  scene::MechanicalState& state = only_state(scene);
  output::AbaqusDeck deck;
  deck.title = options.scene.file.stem().string();
  scene::Component* settings = find_settings(scene);
  const long num_steps = settings && settings->is_given("steps") ? settings->integer("steps") : 1;
  deck.time = options.time ? *options.time : time_of_greatest_loads(scene, state, num_steps);
  deck.loads = loads_at(deck.time, scene, state);
  deck.is_free = free_directions(scene, state);
  return deck;
}

}  // namespace

void export_mesh(const MeshExportOptions& options) {
  SceneOptions scene_options = options.scene;
  scene_options.output.writes = false;
  scene::Scene scene = load_scene(scene_options);
  const std::filesystem::path out = output_place(options.out, scene.root().files().inputs);
  scene::MechanicalState& state = only_state(scene);
  const scene::ForceField* field = find_body(scene);
  if (!field)
    throw scene::SceneError(
        scene::format_error(scene.root().place(), "no body in the scene: there is nothing to export"));

  if (options.format == "vtu") {
    output::write_vtu(out, *field->body(), state.positions(), state.velocities(),
                      field->body()->fields(state.positions()));
  } else {
    output::write_abaqus_deck(out, *field->body(), deck_of(scene, options));
  }
}

}  // namespace hexaplast::runner
