// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/run/scene_file.hpp"

namespace hexaplast::runner {

/// `hexaplast bench`, as the command line gives it.
struct BenchOptions {
  std::optional<std::string> json;  ///< file of the records; "-": standard output, and no table
  std::vector<std::string> sizes;   ///< of the bars; empty: 1k, 10k, 100k, or those of a batch
  std::vector<int> threads{1, 2};
  bool quick = false;
  bool flow = false;      ///< an elastic step, and those in which a part flows and all does, in turn
  bool is_batch = false;  ///< many small bodies in place of a large one
  int bodies = 64;        ///< of a batch
  std::string simd;       ///< instruction set; empty: the best
  std::optional<std::filesystem::path> baseline;
  double ratio = 0.5;  ///< of the baseline's lead over the dense peer
  SceneOptions scene;  ///< measured instead of the bars where it has a file
};

/// Measures, prints the table, writes the records. Throws NumericalError, after everything is written, where threads
/// disagree, a body of a batch has other bits than alone, a solver stalls or a record falls behind the baseline;
/// UsageError for a size or instruction set that makes no sense; what the modules below throw.
void bench(const BenchOptions& options);

}  // namespace hexaplast::runner
