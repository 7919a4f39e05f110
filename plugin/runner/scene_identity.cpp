// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/scene_identity.hpp"

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/hash.hpp"
#include "runner/scene_record.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::runner {

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

}  // namespace hexaplast::runner
