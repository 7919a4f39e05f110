// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/base/simd.hpp"
#include "output/recorder.hpp"
#include "runner/exit_code.hpp"
#include "runner/interrupt.hpp"
#include "runner/progress.hpp"
#include "runner/simulation.hpp"
#include "runner/staging.hpp"

namespace hexaplast::runner {
namespace {

using std::filesystem::path;

output::RunPlan plan_of(Simulation& simulation, long num_steps, const RunOptions& options) {
  output::RunPlan plan;
  plan.title = options.scene.file.stem().string();
  plan.num_steps = num_steps;
  plan.dt = simulation.dt();
  plan.output_every = simulation.output_every();
  plan.num_frames = options.frames.value_or(plan.num_frames);
  plan.force = options.force;

  std::set<int> loaded;
  for (const scene::ForceField* field : simulation.scene().root().all<scene::ForceField>())
    if (scene::acts_on(*field, simulation.state()))
      loaded.insert(field->loaded_nodes().begin(), field->loaded_nodes().end());
  plan.loaded_nodes.assign(loaded.begin(), loaded.end());
  plan.staging = staging_of(simulation);
  return plan;
}

// Steps until the end, a signal, or a failure. After a failure the files hold everything up to the last good step.
void advance(Simulation& simulation, long num_steps, output::Recorder* recorder, bool shows_progress) {
  const auto record = [&] {
    if (recorder)
      recorder->record(simulation.latest(), simulation.state().positions(), simulation.state().velocities());
  };
  record();

  Progress progress(num_steps, shows_progress);
  while (simulation.latest().step < num_steps && requested_signal() == 0) {
    try {
      simulation.step();
    } catch (const NumericalError&) {
      if (recorder) recorder->finish();
      throw;
    }
    record();
    const output::StepRecord& latest = simulation.latest();
    progress.show(latest.step, latest.time, latest.flow.yielded);
  }
}

/// Which hexahedra a body has lost, as far as a line holds them.
std::string removed_line(const std::vector<int>& removed, const Totals& totals, int num_pieces) {
  constexpr std::size_t kMostNamed = 8;
  const std::size_t named = std::min(removed.size(), kMostNamed);
  return fmt::format("{} in steps {} to {}, {} connected part{} left: {}{}", removed.size(), totals.first_removal,
                     totals.latest_removal, num_pieces, num_pieces == 1 ? "" : "s",
                     fmt::join(removed.begin(), removed.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                     named < removed.size() ? ", ..." : "");
}

void print_summary(Simulation& simulation, const path& scene_file) {
  const Totals& totals = simulation.totals();
  const long num_steps = simulation.latest().step;
  const double per_step = totals.step_ms / static_cast<double>(std::max(num_steps, 1L));
  const Body* body = simulation.body();
  const PointArray& x = simulation.state().positions();
  fmt::print("{}: {} steps of {:.6g} s, to t = {:.6g} s\n", scene_file.stem().string(), num_steps, simulation.dt(),
             simulation.time());
  fmt::print("  nodes               {}\n", simulation.state().num_nodes());
  if (body) {
    const output::Summary summary = output::summarise(*body, x);
    const Vec3& place = summary.largest_strain_place;
    fmt::print("  hexahedra           {}\n", body->mesh().num_elements());
    if (!body->history().removed.empty())
      fmt::print("  removed             {}\n", removed_line(body->history().removed, totals, summary.num_pieces));
    fmt::print("  plastic elongation  {:+.3f} %  (world {:+.3f} %)\n", 100 * summary.plastic_elongation,
               100 * summary.world_elongation);
    fmt::print("  plastic twist       {:+.3f} deg  (world {:+.3f} deg)\n", summary.plastic_twist_deg,
               summary.world_twist_deg);
    fmt::print("  volume error        {:+.4f} %  (worst hexahedron {:.4f} %, world {:+.4f} %)\n",
               100 * (summary.material_volume_ratio - 1), 100 * summary.worst_element_volume_error,
               100 * (summary.world_volume_ratio - 1));
    fmt::print("  largest strain      {:.4f} in hexahedron {} at ({:.4g}, {:.4g}, {:.4g})\n", summary.largest_strain,
               summary.largest_strain_element, place.x(), place.y(), place.z());
    if (num_steps > 0) fmt::print("  speed               {:.1f} hex/ms\n", body->mesh().num_elements() / per_step);
  }
  if (num_steps > 0)
    fmt::print("  step                {:.3f} ms, {:.1f} solver iterations\n", per_step,
               static_cast<double>(totals.iterations) / static_cast<double>(num_steps));
  fmt::print("  instruction set     {}\n", simd_target());
  fmt::print("  state hash          {}\n", output::state_hash(num_steps, x, simulation.state().velocities(), body));
}

void warn_of_stalls(const Simulation& simulation) {
  const auto warn = [&](long steps, const char* what) {
    if (steps > 0)
      spdlog::warn("warning: {} stopped before its tolerance in {} of {} steps", what, steps, simulation.latest().step);
  };
  warn(simulation.totals().stalled_solves, "the linear solver");
  warn(simulation.totals().stalled_averaging, "the rest-to-material averaging");
}

}  // namespace

int run(const RunOptions& options) {
  if (options.threads) set_num_threads(*options.threads);
  watch_signals();

  Simulation simulation(options.scene);
  const Body* body = simulation.body();
  if (!body && (options.out || options.final_state))
    throw scene::SceneError(scene::format_error(simulation.scene().root().place(),
                                                "no body in the scene: --out and --final have nothing to write"));
  const long num_steps = required_steps(simulation, options.steps);

  // opened before the first step, so that a long run does not end in a file that cannot be written
  std::optional<output::Recorder> recorder;
  if (options.out) recorder.emplace(*options.out, *body, plan_of(simulation, num_steps, options));
  std::optional<output::WholeFile> final_state;
  if (options.final_state) final_state.emplace(*options.final_state);

  advance(simulation, num_steps, recorder ? &*recorder : nullptr, !options.quiet);

  const long done = simulation.latest().step;
  scene::MechanicalState& state = simulation.state();
  if (recorder)
    for (const std::string& warning : recorder->finish()) spdlog::warn("warning: {}", warning);
  if (final_state)
    output::write_final(*final_state, done, simulation.time(), state.positions(), state.velocities(), *body);
  if (!options.quiet) print_summary(simulation, options.scene.file);
  if (std::fflush(stdout) != 0) throw output::OutputError("standard output cannot be written");
  log_warnings(simulation.scene());
  warn_of_stalls(simulation);

  const int signal = requested_signal();
  if (signal != 0) spdlog::warn("warning: ended by signal {} after step {} of {}", signal, done, num_steps);
  return signal == 0 ? kOk : kSignalled + signal;
}

}  // namespace hexaplast::runner
