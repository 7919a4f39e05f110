// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/mesh/export.hpp"

#include <fmt/format.h>

#include "hexaplast/body.hpp"
#include "record/vtu.hpp"
#include "runner/mesh/file.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

void export_mesh(const MeshExportOptions& options) {
  require_vtu(options.out);
  scene::Scene scene = load_scene(options.scene);
  const std::filesystem::path out = output_place(options.out, scene.root().files().inputs);
  std::vector<output::Bodies::Entry> entries;
  for (const scene::SceneBody& body : scene::bodies_of(scene))
    entries.push_back({.name = body.name, .body = body.field->body()});
  if (entries.empty())
    throw scene::SceneError(
        scene::format_error(scene.root().place(), "no body in the scene: there is nothing to export"));
  const output::Bodies bodies(std::move(entries));
  const std::vector<scene::MechanicalState*> states = scene::shown_states(scene);
  PointArray x, v;
  const PointArray& positions = scene::positions_of(states, x);
  output::write_vtu(out, bodies, positions, scene::velocities_of(states, v), bodies.fields(positions));
}

}  // namespace hexaplast::runner
