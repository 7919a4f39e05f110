// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/identity.hpp"

#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/hash.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::scene {

bool takes_part(const Data& data) {
  const attributes::Attribute& attribute = data.attribute();
  return data.is_given() && attribute.access != attributes::Access::kIgnored &&
         attribute.access != attributes::Access::kOutput && attribute.name != "name";
}

std::string text_of(Data& data) { return data.link().empty() ? write_value(data.value()) : data.link(); }

std::string hash_scene(Scene& scene) {
  StateHash hash;
  // with its length, so that no two different scenes run together into one text
  const auto add = [&](std::string_view text) {
    const std::uint64_t size = text.size();
    hash.add(&size, sizeof size);
    hash.add(text.data(), text.size());
  };
  for_each_object(scene.root(), [&](const std::string& path, Object& object) {
    add(path);
    add(object.class_name());
    for (const auto& data : object.all_data()) {
      if (!takes_part(*data)) continue;
      add(data->attribute().name);
      add(text_of(*data));
    }
  });
  return hash.text();
}

std::uint64_t identity_of(Scene& scene) {
  StateHash hash;
  Archive archive([&](const void* data, std::size_t size) { hash.add(data, size); });
  std::string graph = hash_scene(scene);
  archive(graph);
  for (Topology* topology : scene.root().all<Topology>()) {
    PointArray positions = topology->positions();
    std::vector<Hexahedron> hexahedra = topology->hexahedra();
    std::vector<double> fill(topology->fill().begin(), topology->fill().end());
    archive(positions, hexahedra, fill);
  }
  for (MechanicalState* state : scene.root().all<MechanicalState>()) archive(state->positions());
  return hash.value();
}

}  // namespace hexaplast::scene
