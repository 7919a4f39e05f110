// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "runner/study/calibration.hpp"
#include "runner/study/experiments.hpp"
#include "runner/study/free_attribute.hpp"
#include "runner/study/worker.hpp"

namespace hexaplast::runner {

/// What --set takes, with the free attributes at a point.
std::vector<std::string> assignments(const std::vector<FreeAttribute>& free, const Point& point);

/// The values of runs at a point, column after column; none where a scene does not run with them. Throws
/// Interrupted.
std::optional<std::vector<double>> evaluate(const Experiments& experiments, const std::vector<FreeAttribute>& free,
                                            const Point& point);

/// Runs of the scenes at points, several at the same time in processes of their own. The values of a point do not
/// depend on how many; what has been run is not run again.
class Evaluations {
 public:
  /// jobs: processes; 1: none but this one. threads: of each. Throws OutputError.
  Evaluations(const Experiments& experiments, const std::vector<FreeAttribute>& free, int jobs, int threads);

  /// By others, at these sockets (Worker::at). Throws UsageError.
  Evaluations(const Experiments& experiments, const std::vector<FreeAttribute>& free, const std::vector<int>& sockets);

  /// In this process. What is wrong with the scene is thrown.
  const std::vector<double>& first(const Point& point);

  /// Throws Interrupted, OutputError.
  std::vector<std::optional<std::vector<double>>> at(const std::vector<Point>& points);

 private:
  std::vector<std::optional<std::vector<double>>> run(const std::vector<Point>& points);

  const Experiments& experiments_;
  const std::vector<FreeAttribute>& free_;
  std::vector<Worker> workers_;
  std::map<std::vector<std::string>, std::optional<std::vector<double>>> known_;  // by assignments
};

}  // namespace hexaplast::runner
