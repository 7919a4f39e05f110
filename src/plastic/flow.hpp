// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hexaplast/plastic/flow_report.hpp"
#include "plastic/averaging.hpp"
#include "state/history.hpp"
#include "state/linearization.hpp"

namespace hexaplast {

/// What is left of an element's step once it is in the trial history.
struct ElementFlow {
  bool idle = false;      ///< gone, or at rest: the step leaves it as it is
  bool restores = false;  ///< does not flow; its volume is restored, and nothing else
  bool yielded = false, inverted = false, skipped = false, repaired = false;
  bool collapsing = false;   ///< the averaging pressed it towards inversion
  bool rolled_back = false;  ///< its step was taken back because of that
  bool overflowed = false;   ///< some number of its history, or its dissipated energy, is not finite
  double volume_error = 0;   ///< [-] |plastic volume / initial volume - 1| before the step
  double dissipated = 0;     ///< [J]
};

/// Scratch arrays of flow, kept so that a step allocates nothing.
struct FlowWorkspace {
  FlowWorkspace(const Model& model, const History& history);

  History trial;  ///< the history being made, taken over when the step is complete; of isolated rest shapes, and with
                  ///< branches, what flows and relaxes
  std::optional<Averaging> averaging;  ///< none with these
  std::vector<ElementFlow> flows;      ///< per element
  std::vector<unsigned char> changed;  ///< per element: its rest shape is another than before
  std::vector<unsigned char> stays;    ///< per connected part: its step is taken back as a whole

  // what is in `trial` beforehand: all but its rotation maps is as in the history of this version, but for some blocks
  static constexpr unsigned char kRestShapes = 1, kAll = 3;
  long version = -1;
  std::vector<unsigned char> differs;  ///< per block: 0, kRestShapes or kAll
};

/// What the plastic step reports of a body that cannot flow, whose history never changes: the inverted elements and
/// nearly so at the positions that `at` holds, as its screen sees them in single precision.
FlowReport count_inverted(const Model& model, const Linearization& at);

/// One plastic step at the accepted current positions that `at` holds (theory.md section 5). Where `at` is current
/// and screened, elements that its screen finds at rest are passed over; without, all are looked at, to the same
/// result: stretch and rotation flow at every corner, rest shapes, volume restitution, hardening, rest-shape averaging.
/// With branches all elements are looked at, and relax; `at` needs to know the plastic rest shape and the positions.
/// Throws NumericalError naming the element whose history, or the node whose plastic rest position, is not finite; the
/// history is then as before.
FlowReport flow(const Model& model, const Linearization& at, double dt, LinearSolver& solver, History& history,
                FlowWorkspace& work, std::span<const BranchStep> branches = {});

}  // namespace hexaplast
