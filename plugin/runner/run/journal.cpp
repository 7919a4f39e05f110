// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/journal.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <thread>

#include "attributes/stock.hpp"
#include "base/memory.hpp"
#include "base/simd.hpp"
#include "bench/record.hpp"
#include "hexaplast/base/archive.hpp"
#include "hexaplast/base/hash.hpp"
#include "hexaplast/base/parallel.hpp"
#include "page/report.hpp"
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

std::string precision_of(scene::Scene& scene) {
  for (scene::ForceField* field : scene.root().all<scene::ForceField>())
    if (field->body()) return field->find_data("precision") ? field->text("precision") : "double";
  return {};
}

template <class Category>
std::string class_of_first(scene::Scene& scene) {
  const std::vector<Category*> all = scene.root().all<Category>();
  return all.empty() ? "" : std::string(all.front()->class_name());
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

output::Manifest describe_run(scene::Scene& scene) {
  std::error_code error;  // a directory that has gone has no name
  return {.version = HEXAPLAST_VERSION,
          .working_directory = std::filesystem::current_path(error).string(),
          .scene_hash = scene::hash_scene(scene),
          .components = record_scene(scene),
          .threads = num_threads(),
          .simd = simd_target(),
          .precision = precision_of(scene),
          .motion_solver = class_of_first<scene::OdeSolver>(scene),
          .linear_solver = class_of_first<scene::LinearSolver>(scene),
          .processor = bench::processor_name(),
          .cores = static_cast<int>(std::thread::hardware_concurrency()),
          .memory_bytes = physical_memory(),
          .started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))),
          .dt = scene.dt()};
}

Journal::Journal(std::filesystem::path directory, output::Manifest manifest)
    : directory_(std::move(directory)), manifest_(std::move(manifest)) {
  output::write_manifest(directory_, manifest_);
}

void Journal::close(output::RunState state, std::string reason) {
  manifest_.state = state;
  manifest_.exit_reason = std::move(reason);
  manifest_.duration = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  output::write_manifest(directory_, manifest_);
  output::write_report(directory_, manifest_);
}

}  // namespace hexaplast::runner
