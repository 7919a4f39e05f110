// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "runner/exit_code.hpp"
#include "runner/study/factor.hpp"
#include "runner/study/shard.hpp"

namespace hexaplast::runner {

/// What sweep.csv tells of a run, by the names of its summary (summary_file.hpp): what the same scene comes to again.
inline constexpr std::array<std::string_view, 11> kResults = {"plastic_elongation", "plastic_twist_deg",
                                                              "world_elongation",   "world_twist_deg",
                                                              "volume_error",       "largest_plastic_strain",
                                                              "elastic_energy",     "kinetic_energy",
                                                              "dissipated_energy",  "removed",
                                                              "state_hash"};

inline constexpr std::size_t kMaxRuns = 100'000;  ///< of a sweep

/// How a run of a sweep ended.
struct SweepRow {
  int exit_code = 0;
  std::vector<std::string> results;  ///< one per kResults, as in the file; all empty where the run failed
  std::string step_ms = {};          ///< mean wall time of a step; empty where it is not known

  bool is_same_as(const SweepRow& other) const { return exit_code == other.exit_code && results == other.results; }

  /// Results of a run that ended well, or of one that did not: `summary` is null.
  static SweepRow of(int exit_code, const nlohmann::ordered_json& summary);

  /// The result of that name; not a number where the run failed.
  double number(std::string_view result) const;
};

/// sweep.csv: a row per run of all combinations of the factors' values, the last factor's changing fastest. Runs are
/// numbered from 0; the file counts from 1. The table of a shard has only the rows of its own runs, which keep their
/// numbers. Beside it, sweep_times.csv has what is never the same again.
class SweepTable {
 public:
  explicit SweepTable(std::vector<Factor> factors, Shard shard = {});

  const std::vector<Factor>& factors() const { return factors_; }
  long num_runs() const { return static_cast<long>(rows_.size()); }

  bool has(long run) const { return is_own_[static_cast<std::size_t>(run)]; }  ///< it belongs to the shard
  long num_own() const;

  /// Which value each factor has in a run.
  std::vector<std::size_t> choice(long run) const;
  long run_of(const std::vector<std::size_t>& choice) const;
  std::vector<std::string> assignments(long run) const;  ///< PATH.attribute=VALUE, one per factor

  const std::optional<SweepRow>& row(long run) const { return rows_[static_cast<std::size_t>(run)]; }
  void set(long run, SweepRow row) { rows_[static_cast<std::size_t>(run)] = std::move(row); }
  void clear(long run) { rows_[static_cast<std::size_t>(run)].reset(); }

  /// Runs that need no repeating: those that ended well, and those that the scene or the computation itself refused.
  bool is_finished(long run) const;
  long num_finished() const;
  long num_failed() const;

  /// Of the whole sweep: 0 where all ended well, the code of all runs where that is the same, otherwise 4.
  int exit_code() const;

  /// Replaces the file by one with all rows so far, in the order of the runs. Throws OutputError.
  void write(const std::filesystem::path& file) const;
  /// Takes the rows of such a file. Throws OutputError, which names the line, where it is not of these factors or this
  /// shard.
  void read(const std::filesystem::path& file);

  /// The same for the wall times. Reading passes over all that is not of rows that are known.
  void write_times(const std::filesystem::path& file) const;
  void read_times(const std::filesystem::path& file);

 private:
  std::string head() const;
  std::string beginning(long run) const;  // of its line: number and values

  std::vector<Factor> factors_;
  std::vector<std::optional<SweepRow>> rows_;
  std::vector<bool> is_own_;
};

}  // namespace hexaplast::runner
