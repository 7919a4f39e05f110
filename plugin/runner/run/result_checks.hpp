// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "runner/run/simulation.hpp"

namespace hexaplast::runner {

// Errors of energies are measured by what was put in, at its peak: work that is taken back, by a tool that leads tissue
// to where it was, is known no better than it was done. Where nothing was put in, a strain of 1e-6 counts. Without a
// balance of energy nothing is known of energies.

/// Throws NumericalError, which names the latest step, where kinetic and elastic energy are not finite or more than a
/// hundred times what was put in: they come out of nothing.
void require_supplied(const Simulation& simulation);

/// Why the results that a simulation has come to are not to be trusted, a sentence each. None: nothing speaks against
/// them.
std::vector<std::string> check_results(const Simulation& simulation);

}  // namespace hexaplast::runner
