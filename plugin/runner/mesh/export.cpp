// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "hexaplast/body.hpp"
#include "record/vtu.hpp"
#include "runner/mesh/command.hpp"
#include "runner/mesh/file.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/scene_file.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

struct MeshExportOptions {
  SceneOptions scene;
  std::filesystem::path out;
};

/// Writes the bodies of a scene, as they are before the first step, for other programs.
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

}  // namespace

void add_mesh_export(CLI::App& mesh, Call& call) {
  const auto [command, options] =
      add_subcommand(mesh, call, "export", "Write the scene's bodies for other programs", export_mesh,
                     [](const MeshExportOptions& given) { return given.scene.file.string(); });
  add_scene(command, options.scene);
  add_out(command, options.out);
}

}  // namespace hexaplast::runner
