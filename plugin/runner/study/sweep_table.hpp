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

namespace hexaplast::runner {

/// What sweep.csv tells of a run, by the names of its summary (summary_file.hpp).
inline constexpr std::array<std::string_view, 12> kResults = {"plastic_elongation",
                                                              "plastic_twist_deg",
                                                              "world_elongation",
                                                              "world_twist_deg",
                                                              "volume_error",
                                                              "largest_plastic_strain",
                                                              "elastic_energy",
                                                              "kinetic_energy",
                                                              "dissipated_energy",
                                                              "removed",
                                                              "step_ms",
                                                              "state_hash"};

/// How a run of a sweep ended.
struct SweepRow {
  int exit_code = 0;
  std::vector<std::string> results;  ///< one per kResults, as in the file; all empty where the run failed

  /// Results of a run that ended well, or of one that did not: `summary` is null.
  static SweepRow of(int exit_code, const nlohmann::ordered_json& summary);

  /// The result of that name; not a number where the run failed.
  double number(std::string_view result) const;
};

/// sweep.csv: a row per run of all combinations of the factors' values, the last factor's changing fastest. Runs are
/// numbered from 0; the file counts from 1.
class SweepTable {
 public:
  explicit SweepTable(std::vector<Factor> factors);

  const std::vector<Factor>& factors() const { return factors_; }
  long num_runs() const { return static_cast<long>(rows_.size()); }

  /// Which value each factor has in a run.
  std::vector<std::size_t> choice(long run) const;
  long run_of(const std::vector<std::size_t>& choice) const;
  std::vector<std::string> assignments(long run) const;  ///< PATH.attribute=VALUE, one per factor

  const std::optional<SweepRow>& row(long run) const { return rows_[static_cast<std::size_t>(run)]; }
  void set(long run, SweepRow row) { rows_[static_cast<std::size_t>(run)] = std::move(row); }

  /// Runs that need no repeating: those that ended well, and those that the scene or the computation itself refused.
  bool is_finished(long run) const;
  long num_finished() const;
  long num_failed() const;

  /// Of the whole sweep: 0 where all ended well, the code of all runs where that is the same, otherwise 4.
  int exit_code() const;

  /// Replaces the file by one with all rows so far, in the order of the runs. Throws OutputError.
  void write(const std::filesystem::path& file) const;
  /// Takes the rows of such a file. Throws OutputError, which names the line, where it is not of these factors.
  void read(const std::filesystem::path& file);

 private:
  std::string head() const;
  std::string beginning(long run) const;  // of its line: number and values

  std::vector<Factor> factors_;
  std::vector<std::optional<SweepRow>> rows_;
};

}  // namespace hexaplast::runner
