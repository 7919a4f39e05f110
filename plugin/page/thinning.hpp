// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "page/chart.hpp"

namespace hexaplast::output {

/// What is drawn of a table: every row of a short one; of a long one the rows in which a curve is smallest or largest
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

/// The value that the fraction `rank` of the sorted values does not exceed (nearest rank); 0 where there are none.
double percentile(const std::vector<double>& sorted, double rank);

}  // namespace hexaplast::output
