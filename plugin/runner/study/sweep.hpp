// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "record/field_file.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast sweep`, as the command line gives it.
struct SweepOptions {
  SceneOptions scene;
  std::vector<std::string> vary;             ///< PATH.attribute=a:b:n, a:b:n:log or v1,v2,...
  std::filesystem::path out;                 ///< directory of sweep.json, sweep.csv, sweep.svg, messages, data sets
  std::string shard;                         ///< i/n: only these runs; empty: all
  std::vector<std::filesystem::path> merge;  ///< gathers the runs of these directories instead
  std::vector<output::Field> fields;         ///< each run writes these into a data set; empty: none is written
  long every = 1;                            ///< steps between two states of it
  std::optional<long> steps;                 ///< otherwise from the scene's RunSettings
  int jobs = 0;                              ///< runs at a time; 0: as many as the machine has processors for
  std::optional<int> threads;                ///< of each run; otherwise 1
  bool strict = false;                       ///< runs whose results are not to be trusted have failed
  bool force = false;                        ///< begin anew in a directory that holds a sweep
  bool ends_with_stdin = false;              ///< as by a signal, when nobody holds the other end of the pipe any more
};

/// Adds the subcommand with the options that are its own.
CLI::App* add_sweep(CLI::App& app, SweepOptions& options);

/// Runs a scene once for every combination of the varied values, each run in a process of its own, and keeps what they
/// came to in sweep.csv, which is whole at any moment. A directory that holds the same sweep unfinished is continued:
/// its finished runs are not repeated. With `merge`, gathers what shards have come to (sweep_merge.hpp). Returns 0; 4
/// where runs failed; 130 or 143 when a signal ended the sweep. Throws UsageError and OverrideError for what the
/// command line gets wrong, OutputError where the directory holds another sweep, has one at work or cannot be written,
/// and what reading a scene throws.
int sweep(const SweepOptions& options);

}  // namespace hexaplast::runner
