// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/resume.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/simd.hpp"
#include "output/checkpoint.hpp"
#include "output/files.hpp"
#include "runner/directory_lock.hpp"
#include "runner/run.hpp"
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

}  // namespace

CLI::App* add_resume(CLI::App& app, ResumeOptions& options) {
  CLI::App* resume = app.add_subcommand("resume", "Go on with a run from its newest checkpoint");
  resume->add_option("run", options.run, "Directory of a run that wrote checkpoints, or one of them")
      ->type_name("DIR|FILE")
      ->required();
  resume->add_option("--steps", options.steps, "Number of time steps of the whole run, if it is to be another one")
      ->type_name("TOTAL")
      ->check(CLI::Range(0L, 1'000'000'000L));
  resume->add_option("--threads", options.threads, "Number of threads; results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  resume->add_option("--final", options.final_state, "Write the last state as JSON")->type_name("FILE");
  resume->add_flag("--quiet", options.quiet, "Print nothing but errors");
  return resume;
}

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

  RunOptions run_options;
  std::string working_directory, simd;
  Archive archive = start.section("run");
  serialize(archive, run_options, working_directory, simd);
  run_options.out = fs::absolute(file).parent_path();
  run_options.threads = options.threads;
  run_options.quiet = options.quiet;
  run_options.command = options.command;
  if (options.steps) run_options.steps = options.steps;
  if (options.final_state) run_options.final_state = fs::absolute(*options.final_state);
  if (simd != simd_target())
    spdlog::warn("warning: the run was on {} and goes on on {}: its last bits will differ", simd, simd_target());

  // names of files in the scene and in its options are as they were
  fs::current_path(working_directory);
  try {
    return run(run_options, &start);
  } catch (const InputError& error) {
    refuse(error);
  }
}

}  // namespace hexaplast::runner
