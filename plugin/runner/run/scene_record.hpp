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

/// XXH64 of the files of a scene and of its options, before anything that they name is loaded: elements and attributes
/// of the document with its includes, overrides, plugins, grammar. Throws what reading a scene throws.
std::uint64_t hash_scene_files(const SceneOptions& options);

}  // namespace hexaplast::runner
