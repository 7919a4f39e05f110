// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <set>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/base/simd.hpp"
#include "output/recorder.hpp"
#include "runner/exit_code.hpp"
#include "runner/interrupt.hpp"
#include "runner/loads.hpp"
#include "runner/progress.hpp"
#include "runner/scene_file.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::runner {
namespace {

using std::filesystem::path;

/// A scene that is ready to run, and the parts of it that the run looks at.
struct Stage {
  scene::Scene scene;
  scene::MechanicalState* state = nullptr;
  scene::OdeSolver* solver = nullptr;
  const scene::ForceField* body_field = nullptr;  // null: only masses
  long num_steps = 0;
  int output_every = 25;
};

/// What the accepted steps of a run add up to.
struct Progression {
  long step = 0;               ///< how many
  double step_ms = 0;          ///< wall time of all of them, without output
  long iterations = 0;         ///< of all linear solves
  long stalled_solves = 0;     ///< steps whose linear solver stopped before its tolerance
  long stalled_averaging = 0;  ///< steps whose rest-to-material averaging did
  long first_removal = 0;      ///< step in which the body lost its first hexahedron; 0: none
  long latest_removal = 0;
};

Stage set_up(const RunOptions& options) {
  Stage stage;
  stage.scene = load_scene(options.scene);
  stage.state = &only_state(stage.scene);
  stage.solver = &only_solver(stage.scene);
  stage.body_field = find_body(stage.scene);
  if (!stage.body_field && (options.out || options.final_state))
    throw scene::SceneError(scene::format_error(stage.scene.root().place(),
                                                "no body in the scene: --out and --final have nothing to write"));

  scene::Component* settings = find_settings(stage.scene);
  if (settings) stage.output_every = settings->integer("outputEvery");
  if (options.steps) {
    stage.num_steps = *options.steps;
  } else if (settings && settings->is_given("steps")) {
    stage.num_steps = settings->integer("steps");
  } else {
    throw UsageError("the number of steps is not given: neither --steps nor RunSettings.steps in the scene");
  }
  return stage;
}

output::Staging staging_of(Stage& stage) {
  const scene::Node& root = stage.scene.root();
  output::Staging staging;
  std::optional<bool> shows_skins, shows_hexahedra;
  if (const std::vector styles = root.all<scene::VisualStyle>(); !styles.empty()) {
    shows_skins = styles.front()->shows_visual_models();
    shows_hexahedra = styles.front()->shows_behaviour_models();
  }
  for (const scene::VisualModel* model : root.all<scene::VisualModel>())
    if (model->is_carried() && model->points().rows() > 0 && shows_skins.value_or(true))
      staging.skins.push_back({model->points(), model->triangles(), model->quads()});
  staging.shows_hexahedra = shows_hexahedra.value_or(staging.skins.empty());

  const PointArray directions = free_directions(stage.scene, *stage.state);
  for (int n = 0; n < directions.rows(); ++n)
    if (directions.row(n).isZero(0)) staging.fixed_nodes.push_back(n);
  if (const std::vector cameras = root.all<scene::Camera>(); !cameras.empty())
    staging.towards = cameras.front()->towards();
  return staging;
}

output::RunPlan plan_of(Stage& stage, const RunOptions& options) {
  output::RunPlan plan;
  plan.title = options.scene.file.stem().string();
  plan.num_steps = stage.num_steps;
  plan.dt = stage.scene.dt();
  plan.output_every = stage.output_every;
  plan.num_frames = options.frames.value_or(plan.num_frames);
  plan.force = options.force;

  std::set<int> loaded;
  for (const scene::ForceField* field : stage.scene.root().all<scene::ForceField>())
    if (scene::acts_on(*field, *stage.state)) loaded.insert(field->loaded_nodes().begin(), field->loaded_nodes().end());
  plan.loaded_nodes.assign(loaded.begin(), loaded.end());
  plan.staging = staging_of(stage);
  return plan;
}

output::StepRecord record_of(Stage& stage, const Progression& done, const SolveReport& solve, double step_ms) {
  output::StepRecord record;
  record.step = done.step;
  record.time = stage.scene.time();
  record.kinetic_energy = stage.solver->kinetic_energy();
  if (stage.body_field) record.flow = *stage.body_field->flow_report();
  record.solver_iterations = solve.iterations;
  record.residual = solve.residual;
  record.step_ms = step_ms;
  for (const scene::Instrument* instrument : stage.scene.root().all<scene::Instrument>())
    if (const std::optional<Vec3> place = instrument->place(record.time)) record.instruments.push_back(*place);
  return record;
}

// Steps until the end, a signal, or a failure. After a failure the files hold everything up to the last good step.
Progression advance(Stage& stage, output::Recorder* recorder, bool shows_progress) {
  Progression done;
  if (recorder) recorder->record(record_of(stage, done, {}, 0), stage.state->positions(), stage.state->velocities());

  Progress progress(stage.num_steps, shows_progress);
  while (done.step < stage.num_steps && requested_signal() == 0) {
    const auto begin = std::chrono::steady_clock::now();
    SolveReport solve;
    try {
      solve = stage.scene.step();
    } catch (const NumericalError& error) {
      if (recorder) recorder->finish();
      throw NumericalError(
          fmt::format("step {} (from t = {:.6g} s): {}", done.step + 1, stage.scene.time(), error.what()));
    }
    const double step_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();

    ++done.step;
    done.step_ms += step_ms;
    done.iterations += solve.iterations;
    done.stalled_solves += !solve.converged;
    const output::StepRecord record = record_of(stage, done, solve, step_ms);
    done.stalled_averaging += !record.flow.averaging.converged;
    if (record.flow.removed > 0) {
      if (done.first_removal == 0) done.first_removal = done.step;
      done.latest_removal = done.step;
    }
    if (recorder) recorder->record(record, stage.state->positions(), stage.state->velocities());
    progress.show(done.step, record.time, record.flow.yielded);
  }
  return done;
}

/// Which hexahedra a body has lost, as far as a line holds them.
std::string removed_line(const std::vector<int>& removed, const Progression& done, int num_pieces) {
  constexpr std::size_t kMostNamed = 8;
  const std::size_t named = std::min(removed.size(), kMostNamed);
  return fmt::format("{} in steps {} to {}, {} connected part{} left: {}{}", removed.size(), done.first_removal,
                     done.latest_removal, num_pieces, num_pieces == 1 ? "" : "s",
                     fmt::join(removed.begin(), removed.begin() + static_cast<std::ptrdiff_t>(named), ", "),
                     named < removed.size() ? ", ..." : "");
}

void print_summary(Stage& stage, const Progression& done, const path& scene_file) {
  const double per_step = done.step_ms / static_cast<double>(std::max(done.step, 1L));
  const scene::ForceField* field = stage.body_field;
  fmt::print("{}: {} steps of {:.6g} s, to t = {:.6g} s\n", scene_file.stem().string(), done.step, stage.scene.dt(),
             stage.scene.time());
  fmt::print("  nodes               {}\n", stage.state->num_nodes());
  if (field) {
    const Body& body = *field->body();
    const PointArray& x = stage.state->positions();
    const output::Summary summary = output::summarise(body, x);
    const Vec3& place = summary.largest_strain_place;
    fmt::print("  hexahedra           {}\n", body.mesh().num_elements());
    if (!body.history().removed.empty())
      fmt::print("  removed             {}\n", removed_line(body.history().removed, done, summary.num_pieces));
    fmt::print("  plastic elongation  {:+.3f} %  (world {:+.3f} %)\n", 100 * summary.plastic_elongation,
               100 * summary.world_elongation);
    fmt::print("  plastic twist       {:+.3f} deg  (world {:+.3f} deg)\n", summary.plastic_twist_deg,
               summary.world_twist_deg);
    fmt::print("  volume error        {:+.4f} %  (worst hexahedron {:.4f} %, world {:+.4f} %)\n",
               100 * (summary.material_volume_ratio - 1), 100 * summary.worst_element_volume_error,
               100 * (summary.world_volume_ratio - 1));
    fmt::print("  largest strain      {:.4f} in hexahedron {} at ({:.4g}, {:.4g}, {:.4g})\n", summary.largest_strain,
               summary.largest_strain_element, place.x(), place.y(), place.z());
    if (done.step > 0) fmt::print("  speed               {:.1f} hex/ms\n", body.mesh().num_elements() / per_step);
  }
  if (done.step > 0)
    fmt::print("  step                {:.3f} ms, {:.1f} solver iterations\n", per_step,
               static_cast<double>(done.iterations) / static_cast<double>(done.step));
  fmt::print("  instruction set     {}\n", simd_target());
  fmt::print("  state hash          {}\n",
             output::state_hash(done.step, stage.state->positions(), stage.state->velocities(),
                                field ? field->body() : nullptr));
}

void warn_of_stalls(const Progression& done) {
  const auto warn = [&](long steps, const char* what) {
    if (steps > 0) spdlog::warn("warning: {} stopped before its tolerance in {} of {} steps", what, steps, done.step);
  };
  warn(done.stalled_solves, "the linear solver");
  warn(done.stalled_averaging, "the rest-to-material averaging");
}

}  // namespace

int run(const RunOptions& options) {
  if (options.threads) set_num_threads(*options.threads);
  watch_signals();

  Stage stage = set_up(options);
  // opened before the first step, so that a long run does not end in a file that cannot be written
  std::optional<output::Recorder> recorder;
  if (options.out) recorder.emplace(*options.out, *stage.body_field->body(), plan_of(stage, options));
  std::optional<output::WholeFile> final_state;
  if (options.final_state) final_state.emplace(*options.final_state);

  const Progression done = advance(stage, recorder ? &*recorder : nullptr, !options.quiet);

  if (recorder)
    for (const std::string& warning : recorder->finish()) spdlog::warn("warning: {}", warning);
  if (final_state)
    output::write_final(*final_state, done.step, stage.scene.time(), stage.state->positions(),
                        stage.state->velocities(), *stage.body_field->body());
  if (!options.quiet) print_summary(stage, done, options.scene.file);
  if (std::fflush(stdout) != 0) throw output::OutputError("standard output cannot be written");
  log_warnings(stage.scene);
  warn_of_stalls(done);

  const int signal = requested_signal();
  if (signal != 0) spdlog::warn("warning: ended by signal {} after step {} of {}", signal, done.step, stage.num_steps);
  return signal == 0 ? kOk : kSignalled + signal;
}

}  // namespace hexaplast::runner
