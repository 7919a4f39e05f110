// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/study/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <list>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/simd.hpp"
#include "formats/text.hpp"
#include "record/files.hpp"
#include "record/json_file.hpp"
#include "runner/exit_code.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/directory_lock.hpp"
#include "runner/run/interrupt.hpp"
#include "runner/run/progress.hpp"
#include "runner/run/rounded.hpp"
#include "runner/run/scene_record.hpp"
#include "runner/standard_output.hpp"
#include "runner/study/process.hpp"
#include "runner/study/sweep_directory.hpp"
#include "runner/study/sweep_merge.hpp"
#include "runner/study/sweep_table.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kPatience = 100;                           // [ms] a signal may come just before the wait for processes
constexpr auto kBetweenTimes = std::chrono::seconds(1);  // wall times may be lost, results not

std::vector<Factor> read_factors(const std::vector<std::string>& texts) {
  std::vector<Factor> factors;
  std::size_t num_runs = 1;
  for (const std::string& text : texts) {
    Factor factor = parse_factor(text);
    for (const Factor& other : factors)
      if (other.attribute == factor.attribute)
        throw UsageError(fmt::format("--vary {}: this attribute is varied already", text));
    num_runs *= factor.values.size();
    if (num_runs > kMaxRuns) throw UsageError(fmt::format("more than {} runs", kMaxRuns));
    factors.push_back(std::move(factor));
  }
  return factors;
}

// Checks every value against its attribute, so that no run is spent on a mistyped one.
Json plan_of(const SweepOptions& options, scene::Scene& scene, const std::vector<Factor>& factors, const Shard& shard) {
  scene.diagnostics().throw_errors();
  scene::Component* settings = find_settings(scene);
  if (!options.steps && !(settings && settings->is_given("steps")))
    throw UsageError("the number of steps is not given: neither --steps nor RunSettings.steps in the scene");

  Json plan = {{"title", options.scene.file.stem().string()},
               {"scene", options.scene.file.string()},
               {"scene_hash", hash_scene(scene)},
               {"version", HEXAPLAST_VERSION},
               {"simd", simd_target()},
               {"steps", nullptr},
               {"strict", options.strict}};
  if (options.steps) plan["steps"] = *options.steps;
  std::map<const scene::Data*, std::string> varied;
  for (const Factor& factor : factors) {
    for (const std::string& value : factor.values)
      scene::override_attribute(scene, fmt::format("{}={}", factor.attribute, value), "--vary");
    const scene::Data& data = scene::named_attribute(scene, factor.attribute, "--vary");
    if (const auto [other, is_new] = varied.emplace(&data, factor.attribute); !is_new)
      throw UsageError(
          fmt::format("--vary {}: this attribute is varied already, as {}", factor.attribute, other->second));
    const std::string_view unit = data.attribute().unit;
    plan["vary"].push_back({{"attribute", factor.attribute}, {"values", factor.values}});
    if (factor.is_logarithmic) plan["vary"].back()["logarithmic"] = true;
    plan["units"].push_back(unit);
    plan["labels"].push_back(unit.empty() ? factor.attribute : fmt::format("{} [{}]", factor.attribute, unit));
  }
  if (!options.fields.empty()) {
    for (const output::Field field : options.fields) plan["fields"].push_back(output::entry_of(field).word);
    plan["every"] = options.every;
  }
  if (!shard.is_whole()) plan["shard"] = shard.text();
  return plan;
}

std::vector<std::string> arguments_of(const SweepOptions& options, const SweepTable& table, long run,
                                      const SweepDirectory& place) {
  std::vector<std::string> words = {"run",       "--quiet",
                                    "--threads", std::to_string(options.threads.value_or(1)),
                                    "--summary", place.summary(run).string(),
                                    "--force"};
  const auto add = [&](const char* option, const std::string& value) {
    words.emplace_back(option);
    words.push_back(value);
  };
  if (options.steps) add("--steps", std::to_string(*options.steps));
  if (!options.fields.empty()) {
    std::vector<std::string_view> fields;
    for (const output::Field field : options.fields) fields.push_back(output::entry_of(field).word);
    add("--data", place.fields(run).string());
    add("--fields", fmt::format("{}", fmt::join(fields, ",")));
    add("--every", std::to_string(options.every));
  }
  for (const std::string& assignment : options.scene.overrides) add("--set", assignment);
  for (const std::string& assignment : table.assignments(run)) add("--set", assignment);
  for (const std::string& plugin : options.scene.plugins) add("--plugin", plugin);
  for (const fs::path& directory : options.scene.plugin_path) add("--plugin-path", directory.string());
  for (const fs::path& directory : options.scene.mesh_path) add("--mesh-path", directory.string());
  if (options.strict) words.emplace_back("--strict");
  add("--", options.scene.file.string());
  return words;
}

/// The file that a run has written for the table goes, and its folder where the scene writes nothing.
void clear_up(const fs::path& summary_file) {
  std::error_code has_more;
  fs::remove(summary_file);
  fs::remove(summary_file.parent_path(), has_more);
}

/// What a run that has ended says for the table, null where it failed.
Json collect(int exit_code, const fs::path& summary_file) {
  Json summary;
  if (exit_code == kOk) {
    summary = output::read_json(summary_file);
  }
  clear_up(summary_file);
  return summary;
}

std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// The runs of a sweep on their way.
class Runs {
 public:
  Runs(const SweepOptions& options, const SweepDirectory& place, SweepTable& table)
      : options_(options),
        place_(place),
        table_(table),
        max_(static_cast<std::size_t>(options.jobs)),
        is_terminal_(isatty(STDERR_FILENO) != 0),
        progress_(table.num_own(), true) {}

  /// Carries out what is not finished, until all is done or a signal asks to end.
  void carry_out() {
    long next = 0;
    const auto skip_finished = [&] {
      while (next < table_.num_runs() && (!table_.has(next) || table_.is_finished(next))) ++next;
    };
    for (skip_finished(); requested_signal() == 0 && (next < table_.num_runs() || !under_way_.empty());
         skip_finished()) {
      while (under_way_.size() < max_ && next < table_.num_runs()) {
        output::make_directory(place_.files(next));
        under_way_.push_back({next, Process(arguments_of(options_, table_, next, place_), place_.messages(next))});
        ++next;
        skip_finished();
      }
      if (!take_finished()) wait();
      progress_.show(table_.num_finished(),
                     fmt::format("{} failed  {} under way", table_.num_failed(), under_way_.size()));
    }
    end_all();
    table_.write_times(place_.times());
    progress_.clear();
  }

 private:
  struct Run {
    long number;
    Process process;
  };

  /// Until a run ends, or a signal comes.
  void wait() const {
    std::vector<pollfd> waited;
    for (const Run& run : under_way_) waited.push_back({run.process.descriptor(), POLLIN, 0});
    if (options_.ends_with_stdin) waited.push_back({STDIN_FILENO, 0, 0});
    ::poll(waited.data(), waited.size(), kPatience);
    if (options_.ends_with_stdin && waited.back().revents != 0) std::raise(SIGTERM);
  }

  bool take_finished() {
    bool has_any = false;
    // those that a signal to all of us has ended have no result
    for (auto run = under_way_.begin(); run != under_way_.end() && requested_signal() == 0;) {
      const std::optional<int> code = run->process.exit_code();
      if (code) {
        take(run->number, *code);
        has_any = true;
      }
      run = code ? under_way_.erase(run) : std::next(run);
    }
    return has_any;
  }

  void take(long run, int exit_code) {
    const Json summary = collect(exit_code, place_.summary(run));
    table_.set(run, SweepRow::of(exit_code, summary));
    table_.write(place_.table());
    if (const auto now = std::chrono::steady_clock::now(); now - times_written_ > kBetweenTimes) {
      table_.write_times(place_.times());
      times_written_ = now;
    }
    const std::string which =
        fmt::format("run {} of {}: {}", run + 1, table_.num_runs(), fmt::join(table_.assignments(run), " "));
    const SweepRow& row = *table_.row(run);
    if (exit_code != kOk) {
      progress_.clear();
      spdlog::warn("warning: {}: ended with {}: {}", which, exit_code, first_line(place_.messages(run)));
    } else {
      fs::remove(place_.messages(run));
      for (const Json& doubt : summary.at("doubts")) {
        progress_.clear();
        spdlog::warn("warning: {}: {}", which, doubt.get<std::string>());
      }
      if (!is_terminal_)
        fmt::print("{}: plastic elongation {:+.3f} %, twist {:+.3f} deg, {:.3f} ms per step\n", printable_line(which),
                   rounded(100 * row.number("plastic_elongation"), 1e-3),
                   rounded(row.number("plastic_twist_deg"), 1e-3), row.number("step_ms"));
      std::fflush(stdout);
    }
  }

  // Each completes its step; what it has written by then is not kept.
  void end_all() {
    for (Run& run : under_way_) run.process.send(SIGTERM);
    while (!under_way_.empty()) {
      const long number = under_way_.back().number;
      under_way_.pop_back();  // waits for it
      clear_up(place_.summary(number));
      fs::remove(place_.messages(number));
    }
  }

  const SweepOptions& options_;
  const SweepDirectory& place_;
  SweepTable& table_;
  std::size_t max_;
  bool is_terminal_;
  Progress progress_;
  std::list<Run> under_way_;
  std::chrono::steady_clock::time_point times_written_;
};

}  // namespace

CLI::App* add_sweep(CLI::App& app, SweepOptions& options) {
  CLI::App* command =
      app.add_subcommand("sweep", "Run a scene for every combination of attribute values; continues what was begun");
  command
      ->add_option(
          "--vary", options.vary,
          "Values of an attribute: n from a to b, the same in equal factors (:log), or a list; may be repeated")
      ->type_name("PATH.attribute=a:b:n|a:b:n:log|v1,v2,...")
      ->allow_extra_args(false);
  command
      ->add_option("--shard", options.shard,
                   "Only the runs of shard i of n, which depend on their values alone; --merge gathers the shards")
      ->type_name("i/n");
  command
      ->add_option("--merge", options.merge,
                   "Gather the runs of one sweep from the directories of its shards; without SCENE and --vary")
      ->type_name("DIR...");
  CLI::Option* fields = add_fields(*command, options.fields);
  add_every(*command, options.every)->needs(fields);
  command->add_option("--out", options.out, "Directory of sweep.csv, sweep.svg and sweep.json")
      ->type_name("DIR")
      ->required();
  add_steps(*command, options.steps);
  command->add_option("--jobs", options.jobs, "Runs at a time; otherwise as many as there are processors")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  add_threads(*command, options.threads, "Threads of each run. Default 1");
  add_strict(*command, options.strict);
  command->add_flag("--force", options.force, "Begin anew in a directory that holds a sweep");
  command->add_flag("--ends-with-stdin", options.ends_with_stdin)->group("");  // for the Python module
  return command;
}

int sweep(const SweepOptions& given) {
  watch_signals();
  if (!given.merge.empty()) {
    const SceneOptions& scene = given.scene;
    if (!scene.file.empty() || !scene.overrides.empty() || !scene.plugins.empty() || !scene.plugin_path.empty() ||
        !scene.mesh_path.empty() || !given.vary.empty() || !given.shard.empty() || !given.fields.empty() ||
        given.steps || given.threads || given.jobs != 0 || given.strict)
      throw UsageError("--merge takes --out and --force alone: what the sweep is, its shards know");
    return merge_sweep(given.merge, given.out, given.force);
  }
  if (given.scene.file.empty()) throw UsageError("SCENE is required, or --merge");
  if (given.vary.empty()) throw UsageError("--vary is required, or --merge");
  SweepOptions options = given;
  if (options.jobs == 0)
    options.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / options.threads.value_or(1));

  const Shard shard = options.shard.empty() ? Shard() : parse_shard(options.shard);
  SweepTable table(read_factors(options.vary), shard);
  scene::Scene scene = read_scene(options.scene);
  const Json plan = plan_of(options, scene, table.factors(), shard);
  const SweepDirectory place{options.out};
  output::make_directory(place.path);
  const DirectoryLock lock(place.path);
  open(place, plan, options.force, scene.root().files().inputs, table);
  if (const long done = table.num_finished(); done > 0)
    fmt::print("{} of {} runs are done already\n", done, table.num_own());
  table.write_times(place.times());
  table.write(place.table());
  Runs(options, place, table).carry_out();

  if (shard.is_whole()) write_overviews(place, plan, table);
  const int code = conclude(place, plan, table);
  if (const int signal = requested_signal(); signal != 0) {
    spdlog::warn("warning: ended by signal {}; the same command resumes it", signal);
    return kSignalled + signal;
  }
  return code;
}

}  // namespace hexaplast::runner
