// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hexaplast/plastic/flow_report.hpp"
#include "plastic/flow_pass.hpp"
#include "plastic/tear.hpp"

namespace hexaplast {

/// Scratch arrays of flow, kept so that a step allocates nothing.
struct FlowWorkspace {
  FlowWorkspace(const Model& model, const History& history);

  History trial;                       ///< what flows and relaxes, taken over when the step is complete
  std::vector<ElementFlow> flows;      ///< per element
  long version = -1;                   ///< of the history that the trial is a copy of, but for some blocks
  std::vector<unsigned char> differs;  ///< per block: it is one of them
  std::optional<Tear> tear;            ///< of Fracture::kFace, where something can break
};

/// What the plastic step reports of a body that cannot flow, whose history never changes: the inverted elements and
/// nearly so at the positions that `at` holds, as its screen sees them in single precision.
FlowReport count_inverted(const Model& model, const Linearization& at);

/// One plastic step of isolated rest shapes, and of branches, at the accepted current positions that `at` holds
/// (theory.md sections 5.9, 5.10). Where `at` is current and screened, elements that its screen finds at rest are
/// passed over; without, all are looked at, to the same result. With branches all elements are looked at, and relax;
/// `at` needs to know the plastic rest shape and the positions. Throws NumericalError naming the element whose history
/// is not finite; the history is then as before. With Fracture::kFace nothing is removed: work.tear knows what broke.
FlowReport flow(const Model& model, const Linearization& at, double dt, History& history, FlowWorkspace& work,
                std::span<const BranchStep> branches = {});

}  // namespace hexaplast
