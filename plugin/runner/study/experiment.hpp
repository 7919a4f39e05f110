// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "runner/run/scene_file.hpp"
#include "runner/study/target_curve.hpp"

namespace hexaplast::runner {

/// A signal asked for the end while a run was under way.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// A measured curve, and a scene that is run to repeat it. Every row of the curve belongs to a moment of the run: its
/// time or, over force, the first moment, not before that of the row above, at which the loads of the scene have that
/// pull (axial_pull.hpp; the loads of a moment are those of the step that led to it). Between steps all is linear.
class Experiment {
 public:
  /// Reads the scene once, with `assignments`, to find the moments. steps: of the run; needed where the curve is over
  /// force and the scene's RunSettings do not tell. Throws what Simulation throws, UsageError, and SceneError, which
  /// names the row of the curve that the run does not come to.
  Experiment(SceneOptions scene, TargetCurve target, std::optional<long> steps,
             const std::vector<std::string>& assignments);

  /// What a run with these assignments gives: one value per row, for each of the target's columns. As long as the curve
  /// needs it. Throws what Simulation throws; Interrupted.
  std::vector<std::vector<double>> run(const std::vector<std::string>& assignments) const;

  /// Size of the largest value of a column.
  double greatest(std::size_t column) const { return greatest_[column]; }

  const SceneOptions& scene() const { return scene_; }
  const TargetCurve& target() const { return target_; }
  const InputFiles& inputs() const { return inputs_; }  ///< what the scene reads, and the curve

 private:
  SceneOptions with(const std::vector<std::string>& assignments) const;

  SceneOptions scene_;
  TargetCurve target_;
  InputFiles inputs_;
  std::vector<double> moments_;   // [s] per row, not descending
  std::vector<double> greatest_;  // per column: size of its largest value
};

}  // namespace hexaplast::runner
