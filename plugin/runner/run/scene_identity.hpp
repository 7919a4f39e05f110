// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

#include "runner/run/scene_file.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// XXH64 of a scene as it is carried out, right after init: what hash_scene takes in, and the points and cells of all
/// topologies, from whatever files they come. Scenes of the same identity do the same, bit for bit, on the same
/// instruction set.
std::uint64_t identity_of(scene::Scene& scene);

/// XXH64 of the files of a scene and of its options, before anything that they name is loaded: elements and attributes
/// of the document with its includes, overrides, plugins, grammar. Throws what reading a scene throws.
std::uint64_t hash_scene_files(const SceneOptions& options);

}  // namespace hexaplast::runner
