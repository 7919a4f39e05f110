// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/measured.hpp"

#include <fmt/format.h>

#include <utility>

#include "hexaplast/geometry/sections.hpp"
#include "runner/command.hpp"
#include "runner/run/boundary_conditions.hpp"

namespace hexaplast::runner {

Measured::Measured(Simulation& simulation, std::vector<std::string> names)
    : simulation_(simulation),
      names_(std::move(names)),
      measurement_(*simulation.bodies()),
      ends_(end_sections(simulation.bodies()->mesh())) {}

std::vector<double> Measured::now() {
  const output::Measures measures = measurement_.measure(simulation_.positions());
  const auto value_of = [&](const std::string& name) {
    if (name == "plastic_elongation") return measures.plastic_elongation;
    if (name == "plastic_twist_deg") return measures.plastic_twist_deg;
    if (name == "current_elongation") return measures.current_elongation;
    if (name == "current_twist_deg") return measures.current_twist_deg;
    if (name == "force") return carried_force();
    throw UsageError(fmt::format("--measure {}: is none of the quantities that are measured", name));
  };
  std::vector<double> values;
  for (const std::string& name : names_) values.push_back(value_of(name));
  return values;
}

double Measured::carried_force() {
  scene::MechanicalState& state = *simulation_.scene_bodies().front().state;
  PointArray forces = PointArray::Zero(state.num_nodes(), 3);
  for (scene::ForceField* field : simulation_.scene().root().all<scene::ForceField>())
    if (field->body()) field->add_force(simulation_.time(), state.positions(), state.velocities(), forces);
  return axial_pull(simulation_.bodies()->mesh(), ends_, -forces);
}

std::vector<double> pulls_of(Simulation& simulation, long num_steps) {
  const HexMesh& mesh = simulation.bodies()->mesh();
  const EndSections ends = end_sections(mesh);
  std::vector<double> pulls = {0};
  for (long step = 0; step < num_steps; ++step)
    pulls.push_back(axial_pull(mesh, ends,
                               loads_at(static_cast<double>(step) * simulation.dt(), simulation.scene(),
                                        *simulation.scene_bodies().front().state)));
  return pulls;
}

}  // namespace hexaplast::runner
