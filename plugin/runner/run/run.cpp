// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "base/simd.hpp"
#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "record/files.hpp"
#include "record/recorder.hpp"
#include "runner/command.hpp"
#include "runner/log.hpp"
#include "runner/process.hpp"
#include "runner/run/boundary_conditions.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/data_file.hpp"
#include "runner/run/journal.hpp"
#include "runner/run/progress.hpp"
#include "runner/run/results.hpp"
#include "runner/run/simulation.hpp"
#include "runner/run/staging.hpp"
#include "runner/study/measured.hpp"
#include "runner/subcommand.hpp"
#include "scene/document.hpp"
#include "scene/identity.hpp"
#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::runner {
namespace {

using std::filesystem::path;

/// Whether a file there is one that another run has written into its own directory.
bool is_of_earlier_run(const path& file) {
  return output::is_of_run(file.filename().string()) && exists(file) && exists(file.parent_path() / "manifest.json");
}

/// Whether a run in `directory` writes a file of that name, or makes a folder above it.
bool is_of_run_in(const path& directory, const path& file) {
  const auto resolved = [](const path& place) {  // the same for all names of a place, whether or not something is there
    return std::filesystem::weakly_canonical((std::filesystem::absolute(place) / "").parent_path());
  };
  const path below = resolved(file).lexically_relative(resolved(directory));
  const std::string first = below.empty() ? "" : below.begin()->string();
  return output::is_of_run(first) || first == "frames";
}

/// Where a file goes that the command line names.
path place_of(const path& file, const RunOptions& options, const InputFiles& inputs) {
  std::vector<path> below;
  if (options.out) below.push_back(*options.out);
  const path place = output_place(file, inputs, below);
  if (options.out && is_of_run_in(*options.out, place))
    throw output::OutputError(file.string() + ": is written by the run itself");
  if (!options.force && is_of_earlier_run(place))
    throw output::OutputError(file.string() + ": is a file of an earlier run; --force replaces it");
  return place;
}

/// Whether joints of a body may open by themselves, be it after a change of its material.
bool tears(const scene::ForceField& field) {
  return field.body() && field.body()->settings().fracture == Fracture::kFace;
}

output::RunPlan plan_of(Simulation& simulation, long num_steps, const RunOptions& options) {
  output::RunPlan plan;
  const std::optional<scene::Description> description = scene::description_of(options.scene.file);
  plan.title = description && !description->heading.empty() ? description->heading : options.scene.file.stem().string();
  plan.num_steps = num_steps;
  plan.dt = simulation.dt();
  plan.has_energy_balance = simulation.latest().energy.has_value();
  plan.output_every = simulation.output_every();
  plan.num_frames = options.frames.value_or(plan.num_frames);
  plan.force = options.force;
  plan.inputs = simulation.scene().root().files().inputs;

  const std::set<int> loaded = loaded_nodes(simulation);
  plan.loaded_nodes.assign(loaded.begin(), loaded.end());
  plan.has_ends = measures_ends(simulation);
  plan.has_plastic_ends = plan.has_ends && simulation.bodies()->has_plastic_rest_at_hand();
  for (const scene::Instrument* instrument : simulation.scene().root().all<scene::Instrument>())
    plan.has_contact = plan.has_contact || instrument->contact_energy().has_value();
  plan.has_instruments = !simulation.scene().root().all<scene::Instrument>().empty();
  plan.has_openings = !simulation.scene().root().all<scene::Blade>().empty();
  simulation.scene().root().for_each<scene::ForceField>(
      [&](const scene::ForceField& field) { plan.has_openings = plan.has_openings || tears(field); });
  plan.has_springs = !simulation.scene().root().all<scene::ShowsSprings>().empty();
  for (const scene::Probe* probe : simulation.probes()) plan.probes.push_back(probe->name());
  plan.staging = view::staging_of(simulation.shown());
  stage(options.pictures, plan.staging);
  if (options.video) plan.video = place_of(*options.video, options, plan.inputs);
  return plan;
}

/// What the checkpoints of a run know of it.
RunRecord record_of(const RunOptions& options, long num_steps) {
  RunRecord record{options, simd_target(), hash_scene_files(options.scene)};
  record.options.steps = num_steps;
  record.options.scene.file = std::filesystem::absolute(options.scene.file).lexically_normal();
  for (std::filesystem::path& directory : record.options.scene.mesh_path)
    directory = std::filesystem::absolute(directory).lexically_normal();
  return record;
}

void write_checkpoint(Simulation& simulation, output::Recorder& recorder, RunRecord& record) {
  const output::CheckpointSection sections[] = {
      {"run", [&](Archive& archive) { serialize(archive, record); }},
      {"scene", [&](Archive& archive) { simulation.serialize(archive); }},
      {"totals", [&](Archive& archive) { simulation.serialize_totals(archive); }},
      {"output", [&](Archive& archive) { recorder.save(archive); }},
  };
  output::write_checkpoint(*record.options.out, simulation.latest().step, simulation.scene_identity(), sections);
}

/// The pictures, which take long and may fail for want of a renderer.
void complete(output::Recorder& recorder) {
  for (const std::string& warning : recorder.finish()) spdlog::warn("warning: {}", warning);
}

/// What a run writes; absent: not asked for.
struct Files {
  std::optional<output::Recorder> recorder;
  std::optional<output::WholeFile> final_state, summary;
  std::optional<DataFile> data;
  std::unique_ptr<output::StateStream> stream;
  std::optional<Measured> measured;

  /// Who takes states for programs in Python; null: nobody.
  output::StateStream* states() { return data ? &data->states() : stream.get(); }
  std::optional<Journal> journal;
};

/// What a data set says of its run, so that it can be used without the scene at hand.
output::StatePlan data_plan_of(Simulation& simulation, long num_steps, const RunOptions& options) {
  output::StatePlan plan{.fields = options.fields, .every = options.every, .measures = options.measures};
  for (const scene::Probe* probe : simulation.probes()) plan.probes.push_back(probe->name());
  plan.attributes = {{"format", "hexaplast run 2"},
                     {"version", HEXAPLAST_VERSION},
                     {"simd", std::string(simd_target())},
                     {"scene", options.scene.file.filename().string()},
                     {"scene_hash", scene::hash_scene(simulation.scene())},
                     {"steps", std::to_string(num_steps)},
                     {"dt", fmt::format("{}", simulation.dt())}};
  for (const std::string& assignment : options.scene.overrides) {
    const std::size_t equals = assignment.find('=');
    plan.overrides.emplace_back(assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  // of several for one attribute the last one counts
  std::ranges::reverse(plan.overrides);
  std::ranges::stable_sort(plan.overrides, {}, &std::pair<std::string, std::string>::first);
  const auto is_repeated = [](const auto& a, const auto& b) { return a.first == b.first; };
  plan.overrides.erase(std::unique(plan.overrides.begin(), plan.overrides.end(), is_repeated), plan.overrides.end());
  return plan;
}

void record_state(Simulation& simulation, Files& files) {
  const output::StepRecord& latest = simulation.latest();
  files.states()->record({.step = latest.step,
                          .time = latest.time,
                          .positions = simulation.positions(),
                          .velocities = simulation.velocities(),
                          .conditions = view::conditions_of(simulation.shown()),
                          .probes = latest.probes,
                          .measures = files.measured ? files.measured->now() : std::vector<double>()});
}

// Steps until the end, a signal, or a failure. After a failure the files hold everything up to the last good step.
void advance(Simulation& simulation, long num_steps, Files& files, const RunOptions& options, RunRecord& kept,
             bool begins) {
  std::optional<output::Recorder>& recorder = files.recorder;
  const auto record = [&] {
    if (recorder)
      recorder->record(simulation.latest(), simulation.positions(), simulation.velocities(),
                       view::conditions_of(simulation.shown()));
    if (files.states() && files.states()->wants(simulation.latest().step)) record_state(simulation, files);
  };
  std::optional<long> saved;  // step of the newest checkpoint
  if (!begins) saved = simulation.latest().step;
  const auto save = [&] {
    saved = simulation.latest().step;
    write_checkpoint(simulation, *recorder, kept);
  };
  if (begins) record();

  Progress progress(simulation.latest().step, num_steps, !options.quiet);
  while (simulation.latest().step < num_steps && requested_signal() == 0) {
    try {
      simulation.step();
      record();
      require_supplied(simulation);
    } catch (const output::OutputError&) {
      throw;  // nothing more can be written
    } catch (...) {
      try {
        if (recorder) complete(*recorder);
      } catch (const output::OutputError& error) {
        spdlog::warn("warning: {}", error.what());
      }
      throw;
    }
    const output::StepRecord& latest = simulation.latest();
    progress.show(latest.step,
                  [&] { return fmt::format("t = {:.3f} s  {} yielded", latest.time, latest.flow.yielded); });
    if (options.checkpoint_every && latest.step % *options.checkpoint_every == 0) save();
  }
  const bool is_ended_early = simulation.latest().step < num_steps;
  if (recorder && (options.checkpoint_every || is_ended_early) && saved != simulation.latest().step) save();
}

/// Brings a simulation to where a checkpoint of its scene was written.
void continue_from(Simulation& simulation, const output::Checkpoint& start) {
  const std::string file = start.file().string();
  if (start.scene_hash() != simulation.scene_identity()) throw another_scene(start);
  Archive scene = start.section("scene"), totals = start.section("totals");
  try {
    simulation.serialize(scene);
    simulation.serialize_totals(totals);
    if (scene.rest() + totals.rest() != 0)
      throw InputError(fmt::format("{} bytes are left", scene.rest() + totals.rest()));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{} cannot be resumed: {}", file, error.what()));
  }
}

void warn_of_averaging(const Simulation& simulation) {
  if (const long steps = simulation.totals().stalled_averaging; steps > 0)
    spdlog::warn("warning: the rest-shape averaging stopped before its tolerance in {} of {} steps", steps,
                 simulation.latest().step);
}

void warn_of_probes(const Simulation& simulation) {
  for (std::size_t p = 0; p < simulation.probes().size(); ++p) {
    const Totals::Extremes& extremes = simulation.totals().probes[p];
    if (simulation.latest().step > 0 && extremes.min == 0 && extremes.max == 0)
      spdlog::warn("warning: the probe '{}' was 0 throughout", simulation.probes()[p]->name());
  }
}

/// Of a run that has all steps of its scene.
void warn_of_blades(Simulation& simulation) {
  const bool has_blades = !simulation.scene().root().all<scene::Blade>().empty();
  if (has_blades && simulation.latest().step > 0 && simulation.bodies()->num_opened() == 0)
    spdlog::warn("warning: nothing was cut: no blade passed between the centres of two hexahedra");
}

output::Manifest manifest_of(Simulation& simulation, long num_steps, const RunOptions& options) {
  output::Manifest manifest = describe_run(simulation.scene());
  manifest.command = options.command;
  manifest.title = options.scene.file.stem().string();
  manifest.scene_file = options.scene.file.string();
  if (const std::optional<scene::Description> description = scene::description_of(options.scene.file)) {
    manifest.heading = description->heading;
    manifest.description = description->words;
  }
  manifest.overrides = options.scene.overrides;
  manifest.steps_asked = num_steps;
  for (scene::Probe* probe : simulation.probes())
    manifest.probes.push_back({.name = probe->name(), .unit = std::string(probe->unit())});
  return manifest;
}

// Steps, completes the files and says what came out.
void carry_out(Simulation& simulation, long num_steps, Files& files, const RunOptions& options, RunRecord& kept,
               bool begins) {
  advance(simulation, num_steps, files, options, kept, begins);

  if (files.states() && simulation.latest().step == num_steps) {  // one that is not complete goes
    if (files.states()->last_step() < num_steps) record_state(simulation, files);
    const output::NamedTexts attributes = {{"state_hash", simulation.state_hash()}};
    if (files.data)
      files.data->complete(attributes);
    else
      files.stream->complete(attributes);
  }
  if (files.recorder) complete(*files.recorder);
  if (files.final_state)
    output::write_final(*files.final_state, simulation.time(), simulation.positions(), simulation.velocities(),
                        *simulation.bodies(), simulation.state_hash());
  if (files.summary) {
    files.summary->write(summary_json(simulation).dump(1) + "\n");
    files.summary->commit();
  }
  if (!options.quiet) print_summary(simulation, options.scene.file);
  flush_standard_output();
  log_warnings(simulation.scene());
  warn_of_averaging(simulation);
  warn_of_probes(simulation);
  if (!options.steps && requested_signal() == 0) warn_of_blades(simulation);
  const std::vector<std::string> doubts = check_results(simulation);
  for (const std::string& doubt : doubts) spdlog::warn("warning: {}", doubt);
  if (options.strict && !doubts.empty() && requested_signal() == 0)
    throw NumericalError(fmt::format("{}", fmt::join(doubts, "; ")));
}

// Of several failures the first one counts: where a disk is full, this cannot be written either.
void note_failure(Journal& journal, const char* reason) {
  try {
    journal.close(output::RunState::kFailed, reason);
  } catch (const output::OutputError& error) {
    spdlog::warn("warning: {}", error.what());
  }
}

int run_from_beginning(const RunOptions& options) { return run(options); }

long parse_every(const std::string& text) {
  constexpr std::string_view kEvery = "every=";
  long steps = 0;
  const char* end = text.data() + text.size();
  if (text.starts_with(kEvery)) {
    const auto [stop, error] = std::from_chars(text.data() + kEvery.size(), end, steps);
    if (error == std::errc() && stop == end && steps >= 1 && steps <= 1'000'000'000L) return steps;
  }
  throw CLI::ValidationError("--checkpoint", fmt::format("'{}' must be every=N with a number of steps from 1", text));
}

}  // namespace

InputError another_scene(const output::Checkpoint& start) {
  return InputError(fmt::format("{} is of another scene: the files that it came from have changed, or its options",
                                start.file().string()));
}

void serialize(Archive& archive, RunRecord& record) {
  RunOptions& options = record.options;
  const auto pass = [&]<class T>(std::optional<T>& value) {
    bool is_given = value.has_value();
    archive(is_given);
    if (!is_given) return value.reset();
    if (archive.reads()) value.emplace();
    archive(*value);
  };
  std::string scene = options.scene.file.string();
  archive(scene);
  options.scene.file = scene;
  std::vector<std::string> mesh_path;
  for (const std::filesystem::path& directory : options.scene.mesh_path) mesh_path.push_back(directory.string());
  archive(mesh_path);
  options.scene.mesh_path.assign(mesh_path.begin(), mesh_path.end());
  archive(options.scene.overrides, options.scene.plugins, options.pictures.field, options.pictures.up,
          options.pictures.regions);
  pass(options.steps);
  pass(options.frames);
  pass(options.checkpoint_every);
  archive(record.simd, record.scene_files);
}

int run(const RunOptions& options, const output::Checkpoint* start) {
  if (options.threads) set_num_threads(*options.threads);
  if (options.parent) end_with(*options.parent);
  watch_signals();

  const KeptWarnings warnings;
  Simulation simulation(options.scene);
  const output::Bodies* bodies = simulation.bodies();
  if (!bodies && (options.out || options.final_state || options.summary || options.data || options.stream >= 0))
    throw scene::SceneError(
        scene::format_error(simulation.scene().root().place(),
                            "no body in the scene: --out, --final, --summary and --data have nothing to write"));
  const long num_steps = required_steps(simulation, options.steps);
  RunRecord kept;
  if (options.out) kept = record_of(options, num_steps);
  // of the scene as it begins
  output::Manifest manifest = manifest_of(simulation, num_steps, options);
  output::RunPlan plan;
  simulation.keep_energy_balance();
  if (options.out) plan = plan_of(simulation, num_steps, options);
  manifest.pictures = plan.staging;
  if (start) continue_from(simulation, *start);

  std::optional<DirectoryLock> lock;
  if (options.out) {
    output::make_directory(*options.out);
    if (!start) lock.emplace(*options.out);
  }

  // Opened before the first step, so that a long run does not end in a file that cannot be written; the recorder last,
  // because it takes an earlier run's files away.
  Files files;
  const InputFiles& inputs = simulation.scene().root().files().inputs;
  if (options.final_state) files.final_state.emplace(place_of(*options.final_state, options, inputs));
  if (options.summary) files.summary.emplace(place_of(*options.summary, options, inputs));
  if (options.data)
    files.data.emplace(place_of(*options.data, options, inputs), *bodies, data_plan_of(simulation, num_steps, options));
  if (options.stream >= 0) {
    files.stream =
        std::make_unique<output::StateStream>(options.stream, *bodies, data_plan_of(simulation, num_steps, options));
    if (!options.measures.empty()) files.measured.emplace(simulation, options.measures);
  }
  if (options.out && start) {
    Archive saved = start->section("output");
    files.recorder.emplace(*options.out, *bodies, std::move(plan), saved);
  } else if (options.out) {
    files.recorder.emplace(*options.out, *bodies, std::move(plan));
  }
  if (options.out) {
    for (const std::string& file : files.recorder->lost_states())
      spdlog::warn("warning: {} is gone: its .pvd file no longer names it", (*options.out / file).string());
    files.journal.emplace(*options.out, std::move(manifest));
  }

  // also of a run that fails: what it had come to in its latest accepted step
  const auto note_result = [&] {
    output::Manifest& result = files.journal->manifest();
    result.steps_done = simulation.latest().step;
    result.warnings = warnings.texts();
    result.state_hash = simulation.state_hash();
    result.summary = figures_of(simulation);
  };
  try {
    carry_out(simulation, num_steps, files, options, kept, !start);
  } catch (const std::exception& error) {
    log_warnings(simulation.scene());  // which may explain it
    if (files.journal) {
      note_result();
      note_failure(*files.journal, error.what());
    }
    throw;
  }

  const int signal = requested_signal();
  if (signal != 0)
    spdlog::warn("warning: ended by signal {} after step {} of {}{}", signal, simulation.latest().step, num_steps,
                 options.out && simulation.latest().step < num_steps
                     ? fmt::format("; hexaplast resume {} continues it", options.out->string())
                     : "");
  if (files.journal) {
    note_result();
    files.journal->close(signal == 0 ? output::RunState::kFinished : output::RunState::kInterrupted,
                         signal == 0 ? "All steps done" : fmt::format("Ended by signal {}", signal));
  }
  return signal == 0 ? kOk : kSignalled + signal;
}

void add_run(CLI::App& app, Call& call) {
  const auto [command, options] = add_subcommand(app, call, "run", "Run a scene headless", run_from_beginning,
                                                 [](const RunOptions& given) { return given.scene.file.string(); });
  options.command = call.words;
  add_scene(command, options.scene);
  add_steps(command, options.steps);
  CLI::Option* out =
      add_option(command, "--out", options.out, "DIR",
                 "Write history.csv, mesh.pvd, frames, manifest.json and report.html into this directory");
  add_final_state(command, options.final_state);
  add_option(command, "--summary", options.summary, "FILE", "Write the results of the run as JSON");
  CLI::Option* data = add_option(command, "--data", options.data, "FILE.h5",
                                 "Write states for other programs into an HDF5 file (docs/studies.md)");
  CLI::Option* fields = add_fields(command, options.fields);
  data->needs(fields);
  add_every(command, options.every)->needs(fields);
  // for programs in Python
  command.add_option("--stream", options.stream)->group("");
  command.add_option("--measure", options.measures)->delimiter(',')->group("");
  command.add_option("--parent", options.parent)->group("");
  add_threads(command, options.threads);
  add_option(command, "--frames", options.frames, "N", "Number of pictures, spread over the run; 0 for none")
      ->check(CLI::Range(0, 100'000))
      ->needs(out);
  command
      .add_option_function<std::string>(
          "--checkpoint", [&every = options.checkpoint_every](const std::string& text) { every = parse_every(text); },
          "Write a checkpoint every N steps, at the end and when a signal ends the run: hexaplast resume continues "
          "from it")
      ->type_name("every=N")
      ->needs(out);
  for (CLI::Option* option : add_pictures(command, options.pictures)) option->needs(out);
  add_video(command, options.video, "Film of the run in real time: .png, animated")->needs(out);
  command.add_flag("--force", options.force, "Replace files of an earlier run");
  add_quiet(command, options.quiet);
  add_strict(command, options.strict);
}

}  // namespace hexaplast::runner
