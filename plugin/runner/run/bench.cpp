// SPDX-License-Identifier: LGPL-2.1-or-later
#include "bench/bench.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "base/simd.hpp"
#include "bench/batch.hpp"
#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "record/recorder.hpp"
#include "runner/command.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/simulation.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

/// `hexaplast bench`, as the command line gives it.
struct BenchOptions {
  std::optional<std::string> json;  ///< file of the records; "-": standard output, and no table
  std::vector<std::string> sizes;   ///< of the bars; empty: 1k, 10k, 100k, or those of a batch
  std::vector<int> threads{1, 2};
  bool quick = false;
  bool flow = false;      ///< an elastic step, and those in which a part flows and all does, in turn
  bool is_batch = false;  ///< many small bodies in place of a large one
  int bodies = 64;        ///< of a batch
  std::string simd;       ///< instruction set; empty: the best
  std::optional<std::filesystem::path> baseline;
  double ratio = 0.5;  ///< of the baseline's lead over the dense peer
  SceneOptions scene;  ///< measured instead of the bars where it has a file
};

constexpr int kLargestSize = 2'000'000;  // what a machine of 8 GB holds
constexpr long kSceneSteps = 100;        // of a scene that does not say how many
constexpr long kSceneWarmUp = 3;         // first steps, which still allocate

/// "800", "12.8k".
int parse_size(std::string_view text) {
  const bool thousands = text.ends_with('k');
  const std::vector<double> number = numbers_in(text.substr(0, text.size() - thousands), ',');
  const double size = (thousands ? 1000 : 1) * (number.size() == 1 ? number[0] : 0);
  if (!(size >= 1 && size <= kLargestSize))
    throw UsageError(fmt::format("--sizes: '{}' is no number of hexahedra from 1 to {}k, such as 800 or 12.8k", text,
                                 kLargestSize / 1000));
  return static_cast<int>(size + 0.5);
}

std::vector<int> parse_sizes(const std::vector<std::string>& texts) {
  std::vector<int> sizes;
  for (const std::string& text : texts) sizes.push_back(parse_size(text));
  return sizes;
}

void choose_simd(const std::string& target) {
  try {
    set_simd_target(target);
  } catch (const InputError& error) {
    throw UsageError(fmt::format("--simd: {}", error.what()));
  }
}

scene::Component* find_linear_solver(scene::Scene& scene) {
  for (scene::LinearSolver* solver : scene.root().all<scene::LinearSolver>()) return solver;
  return nullptr;
}

/// The scene once, from its beginning, with one number of threads.
bench::Record measure_scene(const BenchOptions& options, int threads) {
  set_num_threads(threads);
  Simulation simulation(options.scene);
  const scene::ForceField* field = scene::find_body(simulation.scene());
  if (!field)
    throw scene::SceneError(
        scene::format_error(simulation.scene().root().place(), "no body in the scene: nothing to measure"));
  const Body& body = *field->body();
  const long num_steps = std::max(1L, simulation.num_steps().value_or(kSceneSteps));

  std::vector<double> ms;
  int max_yielded = 0;
  while (simulation.latest().step < num_steps) {
    const output::StepRecord& latest = simulation.step();
    if (latest.step > kSceneWarmUp || num_steps <= kSceneWarmUp) ms.push_back(latest.step_ms);
    max_yielded = std::max(max_yielded, latest.flow.yielded);
  }

  const bench::StepTimes times(std::move(ms));
  const scene::Component* solver = find_linear_solver(simulation.scene());
  bench::Record record;
  record.size = body.mesh().num_elements();
  record.shape = options.scene.file.stem().string();
  record.element = bench::element_name(body.settings());
  record.mode = body.can_flow() ? (max_yielded > 0 ? "plastic" : "plastic_idle") : "elastic";
  record.precision = body.settings().precision == Precision::kDouble ? "double" : "mixed";
  record.solver = solver ? solver->class_name() : "none";
  record.target = "scene";
  record.threads = threads;
  record.simd = simd_target();
  record.processor = bench::processor_name();
  record.iterations = static_cast<double>(simulation.totals().iterations) / static_cast<double>(num_steps);
  record.hex_per_ms = record.size / times.p50;  // steps of a scene differ: the fastest says little
  record.p50_ms = times.p50;
  record.p99_ms = times.p99;
  record.ratio_to_dense_peer = bench::time_peer(body, record.iterations) / times.p50;
  record.residual = simulation.latest().residual;
  record.yielded = static_cast<double>(simulation.latest().flow.yielded) / record.size;
  record.state_hash = simulation.state_hash();
  return record;
}

/// What is read, and so never written over.
InputFiles inputs_of(const BenchOptions& options) {
  InputFiles inputs;
  if (!options.scene.file.empty()) {
    scene::Scene scene = read_scene(options.scene);
    scene.init();  // meshes are read then
    inputs = scene.root().files().inputs;
  }
  if (options.baseline) inputs.add(*options.baseline);
  return inputs;
}

bench::Outcome measure_bars(const BenchOptions& options, bool prints) {
  bench::Options wanted;
  if (!options.sizes.empty()) wanted.sizes = parse_sizes(options.sizes);
  wanted.threads = options.threads;
  wanted.quick = options.quick;
  wanted.flow = options.flow;

  if (prints) fmt::print("{}, {}\n", bench::processor_name(), simd_target());
  return bench::run(wanted, [&](const std::vector<bench::Record>& records) {
    if (!prints) return;
    fmt::print("\n{}", bench::table_head());
    for (const bench::Record& record : records) fmt::print("{}", printable(bench::table_row(record)));
    std::fflush(stdout);
  });
}

bench::BatchOutcome measure_batch(const BenchOptions& options, bool prints) {
  bench::BatchOptions wanted{.threads = options.threads, .num_bodies = options.bodies, .quick = options.quick};
  if (!options.sizes.empty()) wanted.sizes = parse_sizes(options.sizes);
  for (const int size : wanted.sizes) {
    const std::array<int, 3> cells = bench::batch_cells(size);
    const std::int64_t each = std::int64_t{cells[0]} * cells[1] * cells[2], sum = each * options.bodies;
    if (sum > kLargestSize)
      throw UsageError(fmt::format("--bodies {}: with {} hexahedra each these are {}, must be at most {}k together",
                                   options.bodies, each, sum, kLargestSize / 1000));
  }
  if (prints)
    fmt::print("{}, {}; steps of a body per second of processor time, and how many times as fast as alone:\n{}",
               bench::processor_name(), simd_target(), bench::batch_head());
  return bench::run_batch(wanted, [&](const bench::BatchRecord& record) {
    if (!prints) return;
    fmt::print("{}", printable(bench::batch_row(record)));
    std::fflush(stdout);
  });
}

/// What has been measured, and why the command fails.
struct Report {
  std::string json;
  std::vector<std::string> failures;
};

Report measure(const BenchOptions& options, bool prints, const std::vector<bench::Record>& baseline) {
  if (options.is_batch) {
    bench::BatchOutcome outcome = measure_batch(options, prints);
    return {bench::to_json(outcome.records), std::move(outcome.failures)};
  }
  bench::Outcome outcome;
  if (options.scene.file.empty()) {
    outcome = measure_bars(options, prints);
  } else {
    for (const int threads : options.threads) outcome.records.push_back(measure_scene(options, threads));
    outcome.failures = bench::differing_hashes(outcome.records);
    if (prints) {
      fmt::print("{}", bench::table_head());
      for (const bench::Record& record : outcome.records) fmt::print("{}", printable(bench::table_row(record)));
    }
  }
  if (options.baseline)
    for (std::string& sentence : bench::compare(outcome.records, baseline, options.ratio))
      outcome.failures.push_back(std::move(sentence));
  return {bench::to_json(outcome.records), std::move(outcome.failures)};
}

/// Measures, prints the table, writes the records. Throws NumericalError, after everything is written, where threads
/// disagree, a body of a batch has other bits than alone, a solver stalls or a record falls behind the baseline;
/// UsageError for a size or instruction set that makes no sense; what the modules below throw.
void bench(const BenchOptions& options) {
  choose_simd(options.simd);
  const bool prints = options.json != "-";
  // both before the first step, so that a long run does not end in a file that cannot be read or written
  std::vector<bench::Record> baseline;
  if (options.baseline) baseline = bench::read_json(*options.baseline);
  std::optional<output::WholeFile> json;
  if (options.json && prints) json.emplace(output_place(*options.json, inputs_of(options)));

  const Report report = measure(options, prints, baseline);
  if (json) {
    json->write(report.json);
    json->commit();
  } else if (!prints) {
    fmt::print("{}", report.json);
  }
  flush_standard_output();
  if (!report.failures.empty()) throw NumericalError(fmt::format("{}", fmt::join(report.failures, "; ")));
}

}  // namespace

void add_bench(CLI::App& app, Call& call) {
  const auto [command, options] = add_subcommand(
      app, call, "bench",
      "Measure implicit steps of a soft bar, of many small ones, or of a scene, and of a dense reference "
      "implementation; check that results do not depend on threads",
      bench,
      [](const BenchOptions& given) { return given.scene.file.empty() ? "hexaplast" : given.scene.file.string(); });
  add_option(command, "--json", options.json, "FILE|-",
             "Write the records as JSON; - for standard output, without the table");
  CLI::Option* sizes =
      add_option(command, "--sizes", options.sizes, "N,N,...",
                 "Hexahedra of the bars; k for a thousand. Default 1k,10k,100k; with --batch 90,250,1k")
          ->delimiter(',');
  add_option(command, "--threads", options.threads, "N,N,...",
             "Numbers of threads, which must agree bit for bit. Default 1,2")
      ->delimiter(',')
      ->check(CLI::Range(1, kMaxThreads));
  CLI::Option* quick = command.add_flag("--quick", options.quick, "One iteration count, one solver, few repetitions");
  add_option(command, "--simd", options.simd, "TARGET", "Instruction set of the kernels; otherwise the machine's best");
  CLI::Option* baseline = add_option(command, "--baseline", options.baseline, "FILE",
                                     "Fail where records fall behind those of an earlier --json");
  add_option(command, "--ratio", options.ratio, "R",
             "Fraction of the baseline's speed relative to the dense reference that is required. Default 0.5")
      ->check(CLI::Range(0.0, 10.0))
      ->needs(baseline);
  CLI::Option* scene =
      add_option(command, "--scene", options.scene.file, "SCENE", "Measure a scene instead of the bars")
          ->excludes(sizes)
          ->excludes(quick);
  CLI::Option* flow = command
                          .add_flag("--flow", options.flow,
                                    "Measure what flow costs, step by step in turn: elastic bars, those of which a "
                                    "twentieth and all flows, and those that relax")
                          ->excludes(scene);
  CLI::Option* batch = command
                           .add_flag("--batch", options.is_batch,
                                     "Measure many small bars in one process: one after the other, and stepped at "
                                     "once; check that each has the bits that it has alone")
                           ->excludes(scene)
                           ->excludes(flow)
                           ->excludes(baseline);
  add_option(command, "--bodies", options.bodies, "N", "How many. Default 64")
      ->check(CLI::Range(1, 100'000))
      ->needs(batch);
  add_mesh_path(command, options.scene);
  add_plugins(command, options.scene);
}

}  // namespace hexaplast::runner
