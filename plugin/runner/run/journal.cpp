// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/journal.hpp"

#include <fmt/chrono.h>

#include <ctime>
#include <thread>

#include "base/memory.hpp"
#include "base/simd.hpp"
#include "bench/machine.hpp"
#include "hexaplast/base/parallel.hpp"
#include "page/report.hpp"
#include "runner/run/scene_record.hpp"
#include "scene/identity.hpp"

namespace hexaplast::runner {
namespace {

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
          .processor = bench::MachineLimits::processor(),
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
