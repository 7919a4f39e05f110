// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "record/manifest.hpp"
#include "runner/run/scene_file.hpp"
#include "scene/scene.hpp"

namespace hexaplast::runner {

/// The nodes and components of a scene in its order, each with the attributes that a scene file or the command line has
/// given other values than the default ones; RequiredPlugins, which do nothing in a run, are left out. Lists of many
/// numbers are described by how many there are and their XXH64.
std::vector<output::ComponentRecord> record_scene(scene::Scene& scene);

/// XXH64, as 16 hexadecimal digits, over paths, classes and given attributes of all nodes and components, with their
/// values in full: what was carried out, from whichever files and options it came. Files that a scene names (meshes)
/// count by their names.
std::string hash_scene(scene::Scene& scene);

/// XXH64 of a scene as it is carried out, right after init: what hash_scene takes in, and the points and cells of all
/// topologies, from whatever files they come. Scenes of the same identity do the same, bit for bit, on the same
/// instruction set.
std::uint64_t identity_of(scene::Scene& scene);

/// XXH64 of the files of a scene and of its options, before anything that they name is loaded: elements and attributes
/// of the document with its includes, overrides, plugins, grammar. Throws what reading a scene throws.
std::uint64_t hash_scene_files(const SceneOptions& options);

}  // namespace hexaplast::runner
