// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/scene_record.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "attributes/stock.hpp"
#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/hash.hpp"
#include "scene/document.hpp"
#include "scene/identity.hpp"
#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

using attributes::Attribute;

constexpr std::size_t kMaxText = 240;  // [byte] longer values are described

std::string hash_of(std::string_view text) {
  StateHash hash;
  hash.add(text.data(), text.size());
  return hash.text();
}

std::string shortened(const std::string& text) {
  if (text.size() <= kMaxText) return text;
  return fmt::format("{} ... ({} values, XXH64 {})", text.substr(0, text.rfind(' ', kMaxText / 3)),
                     scene::split_words(text).size(), hash_of(text));
}

bool has_default_value(scene::Data& data) {
  const Attribute& attribute = data.attribute();
  return data.link().empty() && !attribute.initial.empty() &&
         data.value() == scene::read_value(attribute, attribute.initial);
}

void add(scene::Element& element, Archive& archive) {
  std::ranges::sort(element.attributes, {}, &scene::ElementAttribute::name);
  std::uint64_t num_attributes = element.attributes.size(), num_children = element.children.size();
  archive(element.tag, num_attributes, num_children);
  for (scene::ElementAttribute& attribute : element.attributes) archive(attribute.name, attribute.value);
  for (scene::Element& child : element.children) add(child, archive);
}

}  // namespace

std::vector<output::ComponentRecord> record_scene(scene::Scene& scene) {
  std::vector<output::ComponentRecord> records;
  scene::for_each_object(scene.root(), [&](const std::string& path, scene::Object& object) {
    if (object.class_name() == attributes::kRequiredPlugin.class_name) return;
    output::ComponentRecord record{path, std::string(object.class_name()), std::string(object.description().help), {}};
    for (const auto& data : object.all_data()) {
      if (!scene::takes_part(*data) || has_default_value(*data)) continue;
      const Attribute& attribute = data->attribute();
      record.attributes.push_back({std::string(attribute.name), shortened(scene::text_of(*data)),
                                   std::string(attribute.unit), std::string(attribute.help)});
    }
    records.push_back(std::move(record));
  });
  return records;
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
