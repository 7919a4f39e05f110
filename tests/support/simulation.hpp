// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

#include "hexaplast/base/hash.hpp"
#include "hexaplast/moving_body.hpp"

namespace hexaplast::support {

using Load = NodalLoad;
using Simulation = MovingBody;
using SimulationSetup = Motion;

/// Of its history.
inline std::string hash_of(const Body& body) {
  StateHash hash;
  body.add_to(hash);
  return hash.text();
}

}  // namespace hexaplast::support
