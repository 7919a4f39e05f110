// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hexaplast::output {

/// Reads a table as history.csv is one, row by row: a line of names that begins with step,time, then a line of as many
/// numbers per row. What is wrong with it is an OutputError with file, line and column.
class HistoryTable {
 public:
  explicit HistoryTable(const std::filesystem::path& file);

  const std::vector<std::string>& columns() const { return columns_; }
  int find(std::string_view column) const;  ///< its number; -1: there is none

  /// The next row, one number per column; empty after the last one. The last row of a run that failed may hold infinite
  /// ones. A last line without line feed is no row: a run that was killed may leave half of one. Valid until the next
  /// call.
  std::span<const double> next();

  static constexpr int kStep = 0, kTime = 1;  // the columns that every table has

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  std::vector<std::string> columns_;
  std::string line_;
  long line_number_ = 1;
  std::vector<double> row_;
};

/// Number of rows of such a table.
long count_rows(const std::filesystem::path& file);

}  // namespace hexaplast::output
