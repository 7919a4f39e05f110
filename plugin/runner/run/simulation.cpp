// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "hexaplast/base/error.hpp"
#include "runner/command.hpp"
#include "scene/identity.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::runner {

namespace {

/// Of all solvers; none where one keeps no balance.
std::optional<EnergyBalance> sum_of(const std::vector<scene::OdeSolver*>& solvers) {
  std::optional<EnergyBalance> sum;
  for (scene::OdeSolver* solver : solvers) {
    const EnergyBalance* own = solver->energy_balance();
    if (!own) return std::nullopt;
    if (sum)
      *sum += *own;
    else
      sum = *own;
  }
  return sum;
}

}  // namespace

Simulation::Simulation(const SceneOptions& options)
    : scene_(load_scene(options)),
      states_(scene::moving_states(scene_)),
      solvers_(scene::integrators_of(scene_)),
      scene_bodies_(scene::bodies_of(scene_)),
      shown_states_(scene::shown_states(scene_)),
      probes_(probes_of(scene_)),
      scene_identity_(identity_of(scene_)) {
  if (scene::Component* settings = find_settings(scene_)) {
    output_every_ = settings->integer("outputEvery");
    end_sections_ = settings->text("endSections");
    if (settings->is_given("steps")) num_steps_ = settings->integer("steps");
  }
  if (!scene_bodies_.empty()) bodies_.emplace(view::entries_of(scene_bodies_));
  latest_ = record_of(0, {}, 0);
  load_time_ = scene_.time();
  note_extremes();
}

const PointArray& Simulation::positions() { return scene::positions_of(shown_states_, positions_); }

const PointArray& Simulation::velocities() { return scene::velocities_of(shown_states_, velocities_); }

int Simulation::num_nodes() {
  int count = 0;
  for (scene::MechanicalState* state : states_) count += state->num_nodes();
  return count;
}

std::string Simulation::state_hash() {
  PointArray x, v;
  return output::state_hash(latest_.step, scene::positions_of(states_, x), scene::velocities_of(states_, v),
                            bodies_ ? bodies_->all() : std::span<const output::Bodies::Entry>());
}

const output::StepRecord& Simulation::step() {
  const long step = latest_.step + 1;
  const auto begin = std::chrono::steady_clock::now();
  const double load_time = scene_.time();
  SolveReport solve;
  try {
    solve = scene_.step();
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("step {} (from t = {:.6g} s): {}", step, load_time, error.what()));
  }
  const double step_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();

  latest_ = record_of(step, solve, step_ms);
  load_time_ = load_time;
  totals_.step_ms += step_ms;
  totals_.iterations += solve.iterations;
  if (solve.iterations > 0) ++totals_.steps_by_preconditioner[static_cast<std::size_t>(solve.preconditioner)];
  if (solve.at_threshold)
    ++totals_.threshold_solves;
  else if (!solve.converged)
    ++(solve.of_newton ? totals_.stalled_newton : totals_.stalled_solves);
  totals_.stalled_averaging += !latest_.flow.averaging.converged;
  totals_.rolled_back += latest_.flow.rolled_back;
  if (latest_.flow.removed > 0) {
    if (totals_.first_removal == 0) totals_.first_removal = step;
    totals_.latest_removal = step;
  }
  if (latest_.flow.inverted > totals_.max_inverted) {
    totals_.max_inverted = latest_.flow.inverted;
    totals_.max_inverted_in = step;
  }
  note_extremes();
  return latest_;
}

void Simulation::keep_energy_balance() {
  for (scene::OdeSolver* solver : solvers_) solver->keep_energy_balance();
  latest_ = record_of(0, {}, 0);
  note_extremes();
}

void Simulation::reset() {
  scene_.reset();
  latest_ = record_of(0, {}, 0);
  load_time_ = scene_.time();
  totals_ = {};
  note_extremes();
}

void Simulation::serialize(Archive& archive) {
  long step = latest_.step;
  archive(step);
  scene_.serialize(archive);
  if (!archive.reads()) return;
  latest_ = record_of(step, {}, 0);
  load_time_ = scene_.time();
}

void Simulation::serialize_totals(Archive& archive) {
  archive(latest_.solver_iterations, latest_.residual, latest_.step_ms, totals_.step_ms, totals_.iterations,
          totals_.stalled_solves, totals_.stalled_newton, totals_.threshold_solves, totals_.stalled_averaging,
          totals_.rolled_back, totals_.first_removal, totals_.latest_removal, totals_.max_inverted,
          totals_.max_inverted_in, totals_.energy_put_in);
  for (long& steps : totals_.steps_by_preconditioner) archive(steps);
  totals_.probes.resize(latest_.probes.size());
  for (Totals::Extremes& probe : totals_.probes) archive(probe.min, probe.min_at, probe.max, probe.max_at);
}

long Simulation::saved_step(Archive archive) {
  long step = 0;
  archive(step);
  return step;
}

void Simulation::note_extremes() {
  if (const std::optional<EnergyBalance>& energy = latest_.energy)
    totals_.energy_put_in = std::max(totals_.energy_put_in, energy->initial + energy->load_work + energy->support_work +
                                                                energy->recovery_work + energy->change_work);
  const double time = latest_.time;
  totals_.probes.resize(latest_.probes.size(), {std::numeric_limits<double>::infinity(), time,
                                                -std::numeric_limits<double>::infinity(), time});
  for (std::size_t p = 0; p < latest_.probes.size(); ++p) {
    Totals::Extremes& extremes = totals_.probes[p];
    const double reading = latest_.probes[p];
    if (reading < extremes.min) extremes.min = reading, extremes.min_at = time;
    if (reading > extremes.max) extremes.max = reading, extremes.max_at = time;
  }
}

output::StepRecord Simulation::record_of(long step, const SolveReport& solve, double step_ms) {
  output::StepRecord record;
  record.step = step;
  record.time = scene_.time();
  for (const scene::OdeSolver* solver : solvers_) record.kinetic_energy += solver->kinetic_energy();
  for (const scene::Instrument* instrument : scene_.root().all<scene::Instrument>())
    if (const std::optional<scene::ContactEnergy> energy = instrument->contact_energy()) {
      record.instrument_work += energy->work;
      record.contact_energy += energy->stored;
      record.friction_loss += energy->friction_loss;
    }
  record.energy = sum_of(solvers_);
  record.flow = scene::flow_of(scene_bodies_);
  record.solver_iterations = solve.iterations;
  record.residual = solve.residual;
  record.step_ms = step_ms;
  scene::Readings readings;
  for (scene::Probe* probe : probes_) record.probes.push_back(probe->read(readings));
  return record;
}

std::string preconditioner_line(const Totals& totals) {
  std::vector<std::string> names, counts;
  for (std::size_t i = 0; i < kPreconditionerNames.size(); ++i) {
    const long steps = totals.steps_by_preconditioner[i];
    if (steps == 0) continue;
    names.emplace_back(kPreconditionerNames[i]);
    counts.push_back(fmt::format("{} in {} {}", kPreconditionerNames[i], steps, steps == 1 ? "step" : "steps"));
  }
  return fmt::format("{}", fmt::join(names.size() == 1 ? names : counts, ", "));
}

long required_steps(const Simulation& simulation, std::optional<long> given) {
  if (given) return *given;
  if (simulation.num_steps()) return *simulation.num_steps();
  throw UsageError("the number of steps is not given: neither --steps nor RunSettings.steps in the scene");
}

}  // namespace hexaplast::runner
