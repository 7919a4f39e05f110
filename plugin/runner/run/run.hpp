// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "hexaplast/base/error.hpp"
#include "record/checkpoint.hpp"
#include "record/state_stream.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast run`, as the command line gives it.
struct RunOptions {
  SceneOptions scene;
  std::vector<std::string> command;                  ///< words of the whole command line, for who wants to repeat it
  std::optional<long> steps;                         ///< otherwise from the scene's RunSettings
  std::optional<std::filesystem::path> out;          ///< directory of the run's files; none are written without it
  std::optional<std::filesystem::path> final_state;  ///< JSON of the last state
  std::optional<std::filesystem::path> summary;      ///< JSON of what the run came to (results.hpp)
  std::optional<std::filesystem::path> data;         ///< HDF5 file of states (data_file.hpp)
  std::vector<output::Field> fields;                 ///< that it holds
  long every = 1;                                    ///< steps between its states
  int stream = -1;                                   ///< descriptor for a stream of states (state_stream.hpp); -1: none
  std::vector<std::string> measures;                 ///< that the stream holds (measured.hpp)
  std::optional<int> parent;                         ///< process with which the run ends (process.hpp)
  std::optional<int> threads;
  std::optional<int> frames;                   ///< pictures; needs `out`
  PictureOptions pictures;                     ///< need `out`
  std::optional<std::filesystem::path> video;  ///< film of the run; needs `out`
  std::optional<long> checkpoint_every;        ///< steps; needs `out`
  bool force = false;                          ///< also writes over an earlier run
  bool quiet = false;                          ///< errors only
  bool strict = false;                         ///< results that are not to be trusted are a failure
};

/// Runs a scene headless and returns 0, or 130 or 143 when a signal ended it: then the current step is completed and
/// the files are whole, with a checkpoint where the run has a directory. `start`: a checkpoint of the same scene from
/// which to go on, instead of from the beginning, with the files in `options.out`, which the caller has locked. Throws
/// what the modules below throw, and NumericalError after all files are written where `options.strict` and
/// check_results has something to say. An earlier run in `options.out` is touched last, when all other files could be
/// opened.
int run(const RunOptions& options, const output::Checkpoint* start = nullptr);

/// What a checkpoint knows of its run, beside the state.
struct RunRecord {
  RunOptions options;             ///< but for those of one call, which tell what is loaded, and written where
  std::string simd;               ///< instruction set
  std::uint64_t scene_files = 0;  ///< hash_scene_files
};
void serialize(Archive& archive, RunRecord& record);

/// What is said of a checkpoint whose scene is not the one that is there.
InputError another_scene(const output::Checkpoint& start);

}  // namespace hexaplast::runner
