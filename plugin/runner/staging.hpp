// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "output/gallery.hpp"
#include "runner/simulation.hpp"

namespace hexaplast::runner {

/// How pictures show a scene: its skins, its held nodes and its camera.
output::Staging staging_of(Simulation& simulation);

}  // namespace hexaplast::runner
