// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/experiment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/axial_pull.hpp"
#include "record/measures.hpp"
#include "runner/run/ends.hpp"
#include "runner/run/interrupt.hpp"
#include "runner/run/loads.hpp"
#include "runner/run/simulation.hpp"

namespace hexaplast::runner {
namespace {

constexpr double kSameMoment = 1e-6;  // of a step: the running time is rounded

const output::Bodies& required_bodies(Simulation& simulation) {
  if (!simulation.bodies())
    throw scene::SceneError(
        scene::format_error(simulation.scene().root().place(), "no body in the scene: there is nothing to fit"));
  return *simulation.bodies();
}

/// As many as there are probes: there is none of that name.
std::size_t place_of_probe(const Simulation& simulation, const std::string& name) {
  const std::vector<scene::Probe*>& probes = simulation.probes();
  return static_cast<std::size_t>(std::ranges::find(probes, name, &scene::Probe::name) - probes.begin());
}

/// Gives columns of probes the units that these have.
void find_probes(TargetCurve& target, const Simulation& simulation) {
  std::vector<std::string> known;
  for (const QuantityEntry& entry : quantities()) known.emplace_back(entry.column);
  for (const scene::Probe* probe : simulation.probes()) known.push_back(probe->name());
  for (TargetCurve::Column& column : target.columns) {
    if (column.quantity != Quantity::kProbe) continue;
    const std::size_t place = place_of_probe(simulation, column.name);
    if (place == simulation.probes().size())
      throw scene::SceneError(scene::format_error(
          {target.file.string(), target.head_line},
          fmt::format("column '{}' is not known; comparable are {}, and probes of the scene. --compare chooses some "
                      "columns of many",
                      column.name, fmt::join(known, ", "))));
    column.unit = simulation.probes()[place]->unit();
    if (!column.unit.empty()) column.label = fmt::format("{} [{}]", column.name, column.unit);
  }
}

/// Refuses a curve of or over the force that the only body carries or is loaded with, where there are several.
void require_one_body(const TargetCurve& target, Simulation& simulation) {
  const auto of_force = [](const TargetCurve::Column& column) { return column.quantity == Quantity::kForce; };
  if (required_bodies(simulation).is_one()) return;
  if (target.times.empty() || std::ranges::any_of(target.columns, of_force))
    throw scene::SceneError(scene::format_error(
        {target.file.string(), target.head_line},
        fmt::format("column 'force': is that of the only body, and the scene has {}; a Probe of the scene can be "
                    "compared over time",
                    simulation.scene_bodies().size())));
}

/// Refuses to compare elongation or twist where the scene does not stretch or twist its body by its ends.
void require_ends(const TargetCurve& target, Simulation& simulation) {
  for (const TargetCurve::Column& column : target.columns)
    if (column.quantity != Quantity::kForce && column.quantity != Quantity::kProbe && !measures_ends(simulation))
      throw scene::SceneError(scene::format_error(
          {target.file.string(), target.head_line},
          fmt::format("column '{}': the scene does not stretch or twist its body by the two ends, so that it has "
                      "no elongation and twist; a Probe of the scene can be compared, or RunSettings "
                      "endSections=\"yes\" measures them all the same",
                      column.name)));
}

/// Reads off a body in motion what a curve compares.
class Reader {
 public:
  explicit Reader(Simulation& simulation)
      : simulation_(simulation),
        bodies_(required_bodies(simulation)),
        measurement_(bodies_),
        ends_(end_sections(bodies_.mesh())) {}

  std::vector<double> read(const std::vector<TargetCurve::Column>& columns) {
    const output::Measures measures = measurement_.measure(simulation_.positions());
    std::vector<double> values;
    for (const TargetCurve::Column& column : columns) values.push_back(value_of(column, measures));
    return values;
  }

 private:
  double value_of(const TargetCurve::Column& column, const output::Measures& measures) {
    switch (column.quantity) {
      case Quantity::kElongation:
        return measures.world_elongation;
      case Quantity::kPlasticElongation:
        return measures.plastic_elongation;
      case Quantity::kTwist:
        return measures.world_twist_deg;
      case Quantity::kPlasticTwist:
        return measures.plastic_twist_deg;
      case Quantity::kForce:
        return carried_force();
      case Quantity::kProbe:
        return simulation_.latest().probes[place_of_probe(simulation_, column.name)];
    }
    return 0;
  }

  // Axial force [N] that the middle of the only body carries.
  double carried_force() {
    scene::MechanicalState& state = *simulation_.scene_bodies().front().state;
    PointArray forces = PointArray::Zero(state.num_nodes(), 3);
    for (scene::ForceField* field : simulation_.scene().root().all<scene::ForceField>())
      if (field->body()) field->add_force(simulation_.time(), state.positions(), state.velocities(), forces);
    return axial_pull(bodies_.mesh(), ends_, -forces);
  }

  Simulation& simulation_;
  const output::Bodies& bodies_;
  output::Measurement measurement_;
  EndSections ends_;
};

/// Pull [N] of the loads per step: what led to the state after it. None led to the first state.
std::vector<double> pulls_of(Simulation& simulation, long num_steps) {
  const HexMesh& mesh = required_bodies(simulation).mesh();
  const EndSections ends = end_sections(mesh);
  std::vector<double> pulls = {0};
  for (long step = 0; step < num_steps; ++step)
    pulls.push_back(axial_pull(mesh, ends,
                               loads_at(static_cast<double>(step) * simulation.dt(), simulation.scene(),
                                        *simulation.scene_bodies().front().state)));
  return pulls;
}

/// The moments [s] of a curve over force.
std::vector<double> moments_of(const TargetCurve& target, const std::vector<double>& pulls, double dt) {
  constexpr double kSame = 1e-9;  // of the largest pull
  const auto [lowest, highest] = std::ranges::minmax(pulls);
  const double slack = kSame * std::max(std::abs(lowest), std::abs(highest));
  std::vector<double> moments;
  double from = 0;  // in steps
  for (std::size_t row = 0; row < target.num_rows(); ++row) {
    const double force = target.forces[row];
    std::optional<double> found;
    for (std::size_t step = static_cast<std::size_t>(from); !found && step + 1 < pulls.size(); ++step) {
      const double begin = pulls[step], end = pulls[step + 1];
      if (force < std::min(begin, end) - slack || force > std::max(begin, end) + slack) continue;
      const double fraction = std::abs(end - begin) > slack ? std::clamp((force - begin) / (end - begin), 0.0, 1.0) : 0;
      const double at = static_cast<double>(step) + fraction;
      if (at >= from - kSameMoment)
        found = std::max(at, from);
      else if (std::abs(end - begin) <= slack)
        found = from;  // it is held, and has been for a while
    }
    if (!found)
      throw scene::SceneError(scene::format_error(
          {target.file.string(), target.lines[row]},
          fmt::format("force {} N: the loads of the scene do not have this pull at {:.6g} s or later; in {} steps of "
                      "{:.6g} s it lies between {:.6g} and {:.6g} N",
                      force, from * dt, pulls.size() - 1, dt, lowest, highest)));
    from = *found;
    moments.push_back(from * dt);
  }
  return moments;
}

}  // namespace

Experiment::Experiment(SceneOptions scene, TargetCurve target, std::optional<long> steps,
                       const std::vector<std::string>& assignments)
    : scene_(std::move(scene)), target_(std::move(target)), moments_(target_.times) {
  Simulation simulation(with(assignments));
  required_bodies(simulation);
  find_probes(target_, simulation);
  require_one_body(target_, simulation);
  require_ends(target_, simulation);
  inputs_ = simulation.scene().root().files().inputs;
  inputs_.add(target_.file);
  if (moments_.empty())
    moments_ = moments_of(target_, pulls_of(simulation, required_steps(simulation, steps)), simulation.dt());
  for (const TargetCurve::Column& column : target_.columns)
    greatest_.push_back(std::abs(std::ranges::max(column.values, {}, [](double value) { return std::abs(value); })));
}

SceneOptions Experiment::with(const std::vector<std::string>& assignments) const {
  SceneOptions scene = scene_;
  scene.overrides.insert(scene.overrides.end(), assignments.begin(), assignments.end());
  return scene;
}

std::vector<std::vector<double>> Experiment::run(const std::vector<std::string>& assignments) const {
  Simulation simulation(with(assignments));
  Reader reader(simulation);
  const std::size_t num_columns = target_.columns.size();
  std::vector<std::vector<double>> found(num_columns);

  double before = simulation.time(), now = before;
  std::vector<double> values_before = reader.read(target_.columns), values = values_before;
  for (std::size_t row = 0; row < moments_.size();) {
    if (moments_[row] > now + kSameMoment * simulation.dt()) {
      if (requested_signal() != 0) throw Interrupted();
      simulation.step();
      before = std::exchange(now, simulation.time());
      values_before = std::exchange(values, reader.read(target_.columns));
      continue;
    }
    const double fraction = now > before ? std::clamp((moments_[row] - before) / (now - before), 0.0, 1.0) : 1;
    for (std::size_t c = 0; c < num_columns; ++c) found[c].push_back(std::lerp(values_before[c], values[c], fraction));
    ++row;
  }
  return found;
}

}  // namespace hexaplast::runner
