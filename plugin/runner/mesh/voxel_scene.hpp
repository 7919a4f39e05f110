// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <map>
#include <string>

#include "hexaplast/geometry/voxels.hpp"

namespace hexaplast::runner {

/// A scene for a mesh of voxels in metres: a material for each label, supports, an embedded surface, a ball that
/// presses in from the side opposite to the supports, and probes.
struct VoxelScene {
  std::string title;
  std::string mesh_file, surface_file;  ///< as the scene names them
  std::string hold;                     ///< a side of kSides, or "x0 y0 z0 x1 y1 z1": the box of what is held [m]
  std::map<int, std::string> names;     ///< of labels, where they have one
};

/// Sides of a body in the frame LPS, in its order of axes, the greater coordinate first.
inline constexpr std::array<std::string_view, 6> kSides = {"left", "right", "back", "front", "head", "foot"};

/// Whether a word can be VoxelScene::hold.
bool is_hold(const std::string& word);

/// Its text. surface: the points of the surface that is embedded. Throws InputError where no node, or every one, lies
/// in the box of what is held.
std::string scene_of_voxels(const VoxelScene& options, const VoxelMesh& made, const PointArray& surface);

}  // namespace hexaplast::runner
