// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/linear_system.hpp"
#include "hexaplast/plastic/flow.hpp"

namespace hexaplast::python {

/// What one time step did.
struct StepReport {
  SolveReport solve;
  FlowReport flow;
};

}  // namespace hexaplast::python
