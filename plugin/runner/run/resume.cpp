// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "base/simd.hpp"
#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "record/checkpoint.hpp"
#include "record/files.hpp"
#include "record/recorder.hpp"
#include "runner/command.hpp"
#include "runner/process.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/journal.hpp"
#include "runner/run/run.hpp"
#include "runner/run/simulation.hpp"
#include "runner/subcommand.hpp"
#include "scene/diagnostics.hpp"

namespace hexaplast::runner {
namespace {

namespace fs = std::filesystem;

fs::path newest_checkpoint(const fs::path& run) {
  const std::vector<fs::path> all = output::checkpoints_in(run);
  if (all.empty())
    throw output::OutputError(
        fmt::format("{}: holds no checkpoint (run --checkpoint every=N writes them)", run.string()));
  return all.front();
}

/// The other checkpoint beside one that cannot be used.
std::string hint_of(const fs::path& directory, const fs::path& damaged) {
  for (const fs::path& other : output::checkpoints_in(directory))
    if (other.filename() != damaged.filename()) return fmt::format("there is another one, {}", other.string());
  return {};
}

// The messages of the files say which file it is: the directory need not stand before it once more.
[[noreturn]] void refuse(const InputError& error, const std::string& hint = {}) {
  throw scene::SceneError(scene::format_error({"hexaplast", 0}, error.what(), hint));
}

output::Checkpoint open(const fs::path& directory, const fs::path& file) {
  try {
    return output::Checkpoint(file);
  } catch (const InputError& error) {
    refuse(error, hint_of(directory, file));
  }
}

/// A record may say anything: what the command line of a run would not be let pass is refused here too.
void require_sound(const RunOptions& options, const fs::path& file) {
  constexpr long kMaxSteps = 1'000'000'000;
  const bool is_sound = options.steps && *options.steps >= 0 && *options.steps <= kMaxSteps &&
                        (!options.frames || (*options.frames >= 0 && *options.frames <= 100'000)) &&
                        (!options.checkpoint_every || (*options.checkpoint_every >= 1));
  if (!is_sound)
    throw InputError(fmt::format("{} is damaged: its steps, frames or checkpoints cannot be", file.string()));
}

/// All that can be found wrong before anything is loaded that the scene names.
void require_ready(const output::Checkpoint& start, const RunRecord& record, const fs::path& directory) {
  const std::string file = start.file().string();
  for (const std::optional<fs::path>& named : {record.options.final_state, record.options.summary})
    if (named)
      output::WholeFile can_be_made(
          output_place(*named, InputFiles({start.file(), record.options.scene.file}), {directory}));
  const long step = Simulation::saved_step(start.section("scene"));
  if (step >= *record.options.steps)
    throw UsageError(fmt::format("{} has all {} steps of the run already: --steps gives more", file, step));
  if (hash_scene_files(record.options.scene) != record.scene_files) throw another_scene(start);
  Archive saved = start.section("output");
  output::require_saved_files(directory, saved);
}

/// `hexaplast resume`, as the command line gives it.
struct ResumeOptions {
  fs::path run;     ///< directory of a run, whose newest checkpoint counts, or a checkpoint in it
  RunOptions call;  ///< steps: of the whole run; otherwise as many as it was to have
};

/// Goes on with a run from a checkpoint and returns what `run` returns. A stranger may have made the directory: nothing
/// in it says what is loaded, or written where outside of it; that is for these options alone. No plugin is loaded
/// before all is checked that can be without it. Throws OutputError when there is no checkpoint or it cannot be read,
/// InputError when it is damaged, of another format version or of another scene, and what `run` throws.
int resume(const ResumeOptions& options) {
  std::error_code unknown;
  const bool is_run = fs::is_directory(options.run, unknown);
  if (!is_run) output::require_readable(options.run);
  const fs::path directory = is_run                          ? options.run
                             : options.run.has_parent_path() ? options.run.parent_path()
                                                             : fs::path(".");
  const DirectoryLock lock(directory);
  const fs::path file = is_run ? newest_checkpoint(directory) : options.run;
  const output::Checkpoint start = open(directory, file);

  RunRecord record;
  record.options = options.call;
  Archive archive = start.section("run");
  try {
    serialize(archive, record);
    require_sound(record.options, file);
    record.options.out = fs::absolute(directory);
    record.options.scene.untrusted = directory;
    if (options.call.steps) record.options.steps = options.call.steps;
    require_ready(start, record, directory);
    if (record.simd != simd_target())
      spdlog::warn("warning: the run was on {} and is resumed on {}: its last bits will differ",
                   printable_line(record.simd), simd_target());
    return run(record.options, &start);
  } catch (const InputError& error) {
    refuse(error);
  }
}

}  // namespace

void add_resume(CLI::App& app, Call& call) {
  const auto [command, options] = add_subcommand(app, call, "resume", "Go on with a run from its newest checkpoint",
                                                 resume, [](const ResumeOptions& given) { return given.run.string(); });
  RunOptions& run_options = options.call;
  run_options.command = call.words;
  add_option(command, "run", options.run, "DIR|FILE", "Directory of a run that wrote checkpoints, or one of them")
      ->required();
  add_steps(command, run_options.steps, "Number of time steps of the whole run, if it is to be another one")
      ->type_name("TOTAL");
  add_threads(command, run_options.threads);
  add_final_state(command, run_options.final_state);
  add_option(command, "--summary", run_options.summary, "FILE", "Write what the run came to as JSON");
  add_option(command, "--plugin-path", run_options.scene.plugin_path, "DIR",
             "Directory to look for plugins in, not below the run's; may be repeated")
      ->allow_extra_args(false);
  add_quiet(command, run_options.quiet);
  add_strict(command, run_options.strict);
}

}  // namespace hexaplast::runner
