// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "runner/run/simulation.hpp"

namespace hexaplast::runner {

/// Whether elongation and twist between the end sections of the longest axis are measured: as RunSettings.endSections
/// says, or if there is one body that is stretched or twisted by its ends: what fixes, moves or loads nodes acts on
/// both end sections, and otherwise on whole cross sections alone.
bool measures_ends(Simulation& simulation);

}  // namespace hexaplast::runner
