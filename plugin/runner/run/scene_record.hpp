// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

#include "record/manifest.hpp"
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

}  // namespace hexaplast::runner
