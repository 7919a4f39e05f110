// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "picture/bodies.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/gallery.hpp"
#include "picture/regions.hpp"
#include "scene/parts.hpp"
#include "scene/scene.hpp"

namespace hexaplast::view {

/// A scene in motion, as its pictures show it.
struct ShownScene {
  scene::Scene& scene;
  const output::Bodies* bodies;  ///< null: there are only masses
  const std::vector<scene::SceneBody>& scene_bodies;
  double load_time;  ///< [s] at which the latest step took its loads, its beginning
};

/// The bodies of a scene as pictures and files take them.
std::vector<output::Bodies::Entry> entries_of(const std::vector<scene::SceneBody>& bodies);

/// From the root, as --set takes it: "bar/tumour".
std::string path_of(const scene::Component& component);

/// Ones, and zeros for the degrees of freedom that constraints hold: num_nodes x 3.
PointArray free_directions(scene::Scene& scene, scene::MechanicalState& state);

/// Nodes of the bodies that are fixed or prescribed in all three directions, ascending.
std::vector<int> fixed_nodes(const ShownScene& shown);

/// What holds and loads the bodies: loads at present positions, as they were at the beginning of the latest step, which
/// is when steps take them; loads on states that follow are carried up to theirs. Without weight.
output::BoundaryConditions conditions_of(const ShownScene& shown);

/// The regions as pictures and files tell of them: a hexahedron is in the last one that gives it values.
output::Regions shown_regions(scene::Scene& scene, const output::Bodies& bodies);

/// "liver, tumour, hexahedron 12", with the number that the hexahedron has in its body; of no bodies, that in the mesh.
std::string name_of(int hexahedron, std::span<const output::Bodies::Entry> bodies, const output::Regions& regions);

/// How pictures show a scene: its embedded surfaces, its camera, and what of it.
output::Staging staging_of(const ShownScene& shown);

}  // namespace hexaplast::view
