// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/record.hpp"
#include "hexaplast/body.hpp"

namespace hexaplast::bench {

struct Options {
  std::vector<int> sizes{1000, 10000, 100000};  ///< hexahedra
  std::vector<int> threads{1, 2};
  bool quick = false;  ///< 25 iterations and one converged solver only, few repetitions
  /// The default element alone, step by step in turn: elastic, and where all of it and a twentieth flows with joined
  /// and with isolated rest shapes.
  bool flow = false;
};

struct Outcome {
  std::vector<Record> records;
  std::vector<std::string> failures;  ///< what must not be: hashes that differ, solvers that stall, bodies that do not
                                      ///< do what their mode says
};

/// Measures the bar in every size, mode, precision, solver and number of threads, with the dense peer in between.
/// `on_size` is given the records of each size as soon as they are complete.
Outcome run(const Options& options, const std::function<void(const std::vector<Record>&)>& on_size);

/// Times of steps [ms], of any body: the fastest, the median and the one that only a hundredth exceeds.
struct StepTimes {
  double min, p50, p99;
  explicit StepTimes(std::vector<double> ms);
};

/// Of Record.
std::string element_name(const Settings& settings);

/// [ms] of a step of the dense peer on a body of that mesh and elasticity, under gravity, with so many iterations.
double time_peer(const Body& body, double iterations);

}  // namespace hexaplast::bench
