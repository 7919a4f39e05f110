// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <string>

#include "scene/scene.hpp"

/// What a scene is made of, whatever state it is in.
namespace hexaplast::scene {

/// Whether an attribute is given and has an effect.
bool takes_part(const Data& data);

/// Its value or link as a scene writes it.
std::string text_of(Data& data);

/// XXH64, as 16 hexadecimal digits, over paths, classes and given attributes of all nodes and components, with their
/// values in full: what was carried out, from whichever files and options it came. Files that a scene names (meshes)
/// count by their names.
std::string hash_scene(Scene& scene);

/// XXH64 of a scene as it is carried out, right after init: what hash_scene takes in, and the points and cells of all
/// topologies, from whatever files they come. Scenes of the same identity do the same, bit for bit, on the same
/// instruction set.
std::uint64_t identity_of(Scene& scene);

}  // namespace hexaplast::scene
