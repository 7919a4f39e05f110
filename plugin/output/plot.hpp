// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "output/measures.hpp"

namespace hexaplast::output {

/// Collects how a run went and shows it over time: elongation, twist, volume error, yielded hexahedra.
class Plot {
 public:
  Plot(std::string title, int num_elements) : title_(std::move(title)), num_elements_(num_elements) {}

  /// time [s], ascending. Long runs are thinned out evenly, so that memory and file stay small.
  void add(double time, const Measures& measures, int yielded);

  /// Writes the plot as SVG. Throws OutputError.
  void write_svg(const std::filesystem::path& file) const;

 private:
  struct Sample {
    double time = 0;
    Measures measures;
    int yielded = 0;
  };

  std::string title_;
  int num_elements_;
  std::vector<Sample> samples_;  // every stride_-th state
  Sample last_;
  long stride_ = 1;
  long num_added_ = 0;
};

}  // namespace hexaplast::output
