// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "output/chart.hpp"

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

/// What is drawn of a table: every row of a short one; of a long one the rows in which a curve is least or greatest
/// within each of several hundred stretches, so that no peak is lost and the picture stays small.
class Thinning {
 public:
  /// `num_rows` will be added.
  Thinning(long num_rows, std::size_t num_curves);

  void add(long step, double time, std::span<const double> values);  ///< one value per curve

  /// Steps, times, and curves with values alone; call once, after the last row.
  Series take();

 private:
  struct Row {
    long step;
    double time;
    std::vector<double> values;
  };
  void keep(const Row& row);
  void keep_extremes();

  long stride_;
  std::vector<Row> stretch_;
  Row latest_ = {};
  Series kept_;
};

/// The value that the share `rank` of the sorted values does not exceed (nearest rank); 0 where there are none.
double percentile(const std::vector<double>& sorted, double rank);

}  // namespace hexaplast::output
