// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/moving_body.hpp"

namespace hexaplast::support {

using Load = NodalLoad;
using Simulation = MovingBody;
using SimulationSetup = Motion;

}  // namespace hexaplast::support
