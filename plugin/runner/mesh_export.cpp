// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh_export.hpp"

#include "hexaplast/body.hpp"
#include "output/abaqus_deck.hpp"
#include "output/vtu.hpp"
#include "runner/scene_file.hpp"

namespace hexaplast::runner {
namespace {

/// All forces [N] on the undeformed body at rest that do not come from the body itself.
PointArray loads_at(double time, scene::Scene& scene, scene::MechanicalState& state) {
  const PointArray& rest = state.rest_positions();
  const PointArray at_rest = PointArray::Zero(rest.rows(), 3);
  PointArray loads = at_rest;
  state.add_external_force(loads);
  for (const scene::Mass* mass : scene.root().all<scene::Mass>())
    mass->add_gravity(scene.root().clock().gravity, loads);
  for (scene::ForceField* field : scene.root().all<scene::ForceField>())
    if (!field->body()) field->add_force(time, rest, at_rest, loads);
  return loads;
}

/// Time [s] of the first step of the run at which the loads are greatest.
double time_of_greatest_loads(scene::Scene& scene, scene::MechanicalState& state) {
  scene::Component* settings = find_settings(scene);
  const long num_steps = settings && settings->is_given("steps") ? settings->integer("steps") : 1;
  double greatest = -1, found = 0, time = 0;
  for (long step = 0; step < num_steps; ++step, time += scene.dt()) {
    const double size = loads_at(time, scene, state).rowwise().norm().sum();
    // what is held is held within rounding
    if (size <= greatest * (1 + 1e-12)) continue;
    greatest = size;
    found = time;
  }
  return found;
}

output::AbaqusDeck deck_of(scene::Scene& scene, const Body& body, const MeshExportOptions& options) {
  scene::MechanicalState& state = only_state(scene);
  output::AbaqusDeck deck;
  deck.title = options.scene.file.stem().string();
  deck.time = options.time ? *options.time : time_of_greatest_loads(scene, state);
  deck.loads = loads_at(deck.time, scene, state);
  deck.is_free = PointArray::Ones(body.mesh().num_nodes(), 3);
  for (const scene::ProjectiveConstraint* constraint : scene.root().all<scene::ProjectiveConstraint>())
    constraint->project(deck.is_free);
  return deck;
}

}  // namespace

void export_mesh(const MeshExportOptions& options) {
  scene::Scene scene = load_scene(options.scene);
  scene::MechanicalState& state = only_state(scene);
  const scene::ForceField* field = find_body(scene);
  if (!field)
    throw scene::SceneError(
        scene::format_error(scene.root().place(), "no body in the scene: there is nothing to export"));

  if (options.format == "vtu") {
    output::write_vtu(options.out, *field->body(), state.positions(), state.velocities());
  } else {
    output::write_abaqus_deck(options.out, *field->body(), deck_of(scene, *field->body(), options));
  }
}

}  // namespace hexaplast::runner
