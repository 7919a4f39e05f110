// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace hexaplast::support {

/// A table as the commands write it, without quoted fields.
class Csv {
 public:
  explicit Csv(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> fields;
      std::istringstream words(line + ",");
      for (std::string field; std::getline(words, field, ',');) fields.push_back(field);
      (columns_.empty() ? columns_ : rows_.emplace_back()) = std::move(fields);
    }
  }

  const std::vector<std::string>& columns() const { return columns_; }
  std::size_t num_rows() const { return rows_.size(); }

  /// A field, rows counted from 0; empty, and a failure of the test, where it is not there.
  std::string text(std::size_t row, const std::string& column) const {
    const auto found = std::ranges::find(columns_, column);
    const auto at = static_cast<std::size_t>(found - columns_.begin());
    if (found != columns_.end() && row < rows_.size() && at < rows_[row].size()) return rows_[row][at];
    ADD_FAILURE() << "no " << column << " in row " << row << " of " << rows_.size();
    return {};
  }
  double number(std::size_t row, const std::string& column) const {
    std::istringstream words(text(row, column));
    double value = 0;
    EXPECT_TRUE(words >> value) << column << " in row " << row;
    return value;
  }

  /// A column as numbers.
  std::vector<double> numbers(const std::string& column) const {
    std::vector<double> values;
    for (std::size_t row = 0; row < rows_.size(); ++row) values.push_back(number(row, column));
    return values;
  }

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace hexaplast::support
