// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "record/manifest.hpp"

namespace hexaplast::output {

/// Where two runs, A and B, are farthest apart in a column of history.csv.
struct ColumnDifference {
  std::string column;
  double difference = 0;  ///< |A - B|
  double largest = 0;     ///< |value| in A or B, in any row: what the difference may be measured by
  long step = 0;          ///< of A
  double time = 0;        ///< [s]
  double a = 0, b = 0;    ///< the values there
};

/// What the histories of two runs have in common: rows of equal time (to 1e-9 of the run's length), columns of equal
/// name. Steps of different length meet wherever their times do.
struct HistoryComparison {
  long num_rows_a = 0, num_rows_b = 0, num_common = 0;
  std::vector<ColumnDifference> columns = {};  ///< in A's order, without step and time
};

/// Throws OutputError where one of the files cannot be read or is no history.
HistoryComparison compare_histories(const std::filesystem::path& a, const std::filesystem::path& b);

/// A table of a comparison, as the command prints it and the page shows it.
struct ComparisonTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::string note = {};  ///< may be empty
};

/// Two runs beside each other: what they were, where their scenes differ, where their histories and last common states
/// are farthest apart. a, b: directories of runs. Throws OutputError for what is no run or cannot be read, InputError
/// for damaged files and for bodies that are not made of the same hexahedra.
std::vector<ComparisonTable> compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

/// The same as a page of HTML in one file, with the curves of both runs laid over each other.
std::string comparison_page(const std::filesystem::path& a, const std::filesystem::path& b,
                            const std::vector<ComparisonTable>& tables);

}  // namespace hexaplast::output
