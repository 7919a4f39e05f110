// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/scene_identity.hpp"

#include <algorithm>

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/hash.hpp"
#include "runner/run/scene_record.hpp"
#include "scene/document.hpp"
#include "scene/interfaces.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

void add(scene::Element& element, Archive& archive) {
  std::ranges::sort(element.attributes, {}, &scene::ElementAttribute::name);
  std::uint64_t num_attributes = element.attributes.size(), num_children = element.children.size();
  archive(element.tag, num_attributes, num_children);
  for (scene::ElementAttribute& attribute : element.attributes) archive(attribute.name, attribute.value);
  for (scene::Element& child : element.children) add(child, archive);
}

}  // namespace

std::uint64_t identity_of(scene::Scene& scene) {
  StateHash hash;
  Archive archive([&](const void* data, std::size_t size) { hash.add(data, size); });
  std::string graph = hash_scene(scene);
  archive(graph);
  for (scene::Topology* topology : scene.root().all<scene::Topology>()) {
    PointArray positions = topology->positions();
    std::vector<Hexahedron> hexahedra = topology->hexahedra();
    std::vector<double> fill(topology->fill().begin(), topology->fill().end());
    archive(positions, hexahedra, fill);
  }
  for (scene::MechanicalState* state : scene.root().all<scene::MechanicalState>()) archive(state->positions());
  return hash.value();
}

std::uint64_t hash_scene_files(const SceneOptions& options) {
  scene::require_readable(options.file);
  scene::Diagnostics diagnostics;
  scene::Element root = scene::read_document(scene::read_scene_file(options.file), options.file, diagnostics, nullptr,
                                             scene::SearchPath(options.mesh_path));
  diagnostics.throw_errors();
  StateHash hash;
  Archive archive([&](const void* data, std::size_t size) { hash.add(data, size); });
  add(root, archive);
  std::vector<std::string> overrides = options.overrides, plugins = options.plugins;
  archive(overrides, plugins);
  return hash.value();
}

}  // namespace hexaplast::runner
