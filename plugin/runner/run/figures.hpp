// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "record/manifest.hpp"
#include "runner/run/simulation.hpp"

namespace hexaplast::runner {

/// What a run has come to in its latest step, line by line: what it prints, and what its report shows.
std::vector<output::Figure> figures_of(Simulation& simulation);

}  // namespace hexaplast::runner
