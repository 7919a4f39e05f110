// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "hexaplast/geometry/sections.hpp"
#include "record/measures.hpp"
#include "runner/run/simulation.hpp"

namespace hexaplast::runner {

/// What a fit reads off a body in motion beside probes.
class Measured {
 public:
  /// names: of plastic_elongation, plastic_twist_deg, current_elongation, current_twist_deg as in history.csv, and
  /// force: axial force [N] that the middle section of the only body carries; tension is positive. The simulation,
  /// which has a body, must outlive it. now() throws UsageError for another name.
  Measured(Simulation& simulation, std::vector<std::string> names);

  const std::vector<std::string>& names() const { return names_; }
  std::vector<double> now();  ///< one value per name

 private:
  double carried_force();

  Simulation& simulation_;
  std::vector<std::string> names_;
  output::Measurement measurement_;
  EndSections ends_;
};

/// Axial pull [N] of the loads on the only body, per step: what led to the state after it. None led to the first state.
std::vector<double> pulls_of(Simulation& simulation, long num_steps);

}  // namespace hexaplast::runner
