// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "record/files.hpp"
#include "runner/study/sweep_table.hpp"

namespace hexaplast::runner {

/// Where the files of a sweep, or of one of its shards, stand. Runs are numbered from 0; files count from 1.
struct SweepDirectory {
  std::filesystem::path path;

  std::filesystem::path plan() const { return path / "sweep.json"; }
  std::filesystem::path table() const { return path / "sweep.csv"; }
  std::filesystem::path times() const { return path / "sweep_times.csv"; }
  std::filesystem::path picture() const { return path / "sweep.svg"; }
  std::filesystem::path data() const { return path / "sweep.h5"; }
  std::filesystem::path messages(long run) const;
  std::filesystem::path files(long run) const;  ///< what the scene writes in that run
  std::filesystem::path summary(long run) const { return files(run) / "summary.json"; }
  std::filesystem::path fields(long run) const;  ///< data set of that run

  /// Plan and table first.
  std::vector<std::filesystem::path> contents(long num_runs) const;
};

/// The plan of a sweep is what makes two sweeps the same, and all that merging its shards needs: title, scene,
/// scene_hash, version, simd, steps, strict, vary, labels, units; fields and every where there are data sets; shard
/// where it is one.
nlohmann::ordered_json read_plan(const SweepDirectory& directory);
std::vector<Factor> factors_of(const nlohmann::ordered_json& plan);

/// Takes up a sweep that is there, or begins one. The directory is there, and ours alone. Throws OutputError where it
/// holds another sweep, or something that is none.
void open(const SweepDirectory& directory, const nlohmann::ordered_json& plan, bool force, const InputFiles& inputs,
          SweepTable& table);

/// Why two plans are not of the same sweep; empty: they are. Shards are not compared.
std::string difference_of(const nlohmann::ordered_json& plan, const nlohmann::ordered_json& other);

/// Writes what shows all runs together: the picture, and sweep.h5 where the sweep has data sets.
void write_overviews(const SweepDirectory& directory, const nlohmann::ordered_json& plan, const SweepTable& table);

/// Prints how many runs are done and have failed. Returns the exit code of the sweep.
int conclude(const SweepDirectory& directory, const nlohmann::ordered_json& plan, const SweepTable& table);

}  // namespace hexaplast::runner
