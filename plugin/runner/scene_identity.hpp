// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

#include "scene/scene.hpp"

namespace hexaplast::runner {

/// XXH64 of a scene as it is carried out, right after init: what hash_scene takes in, and the points and cells of all
/// topologies, from whatever files they come. Scenes of the same identity do the same, bit for bit, on the same
/// instruction set.
std::uint64_t identity_of(scene::Scene& scene);

}  // namespace hexaplast::runner
