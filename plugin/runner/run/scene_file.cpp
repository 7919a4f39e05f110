// SPDX-License-Identifier: LGPL-2.1-or-later
#include "runner/run/scene_file.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string_view>

#include "scene/reader.hpp"

namespace hexaplast::runner {
namespace {

using std::filesystem::path;

path installed_plugins() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / HEXAPLAST_PLUGINS_FROM_BIN)
      .lexically_normal();
}

}  // namespace

scene::PluginLoader load_components(scene::Factory& factory, const SceneOptions& options) {
  scene::PluginLoader loader(factory, options.plugin_path, installed_plugins(), options.untrusted);

  // The stock components live in a plugin too: every scene needs it, whether it says so or not.
  std::vector<std::string> names = {"Hexaplast"};
  names.insert(names.end(), options.plugins.begin(), options.plugins.end());
  for (const std::string& name : names) {
    try {
      loader.load(name);
    } catch (const scene::PluginError& error) {
      throw scene::PluginError(scene::format_error({"hexaplast", 0}, error.what()));
    }
  }
  return loader;
}

scene::Scene read_scene(const SceneOptions& options) {
  // Both are needed for reading alone: the code of a loaded plugin stays.
  scene::Factory factory;
  scene::PluginLoader plugins = load_components(factory, options);

  scene::Scene scene = scene::read_scene(options.file, factory, plugins, scene::SearchPath(options.mesh_path));
  // A scene with mistakes may lack what an override is meant for: then init reports the mistakes.
  if (!scene.diagnostics().has_errors())
    for (const std::string& assignment : options.overrides) scene::override_attribute(scene, assignment);
  return scene;
}

scene::Scene load_scene(const SceneOptions& options) {
  scene::Scene scene = read_scene(options);
  try {
    scene.init();
  } catch (const std::exception&) {
    for (const scene::Message& message : scene.diagnostics().take_warnings())  // which may explain the errors
      if (message.severity == scene::Severity::kWarning) spdlog::warn("{}", scene::format(message));
    throw;
  }
  log_warnings(scene);
  return scene;
}

void log_warnings(scene::Scene& scene) {
  for (const scene::Message& message : scene.diagnostics().take_warnings()) {
    const bool is_note = message.severity == scene::Severity::kNote;
    spdlog::log(is_note ? spdlog::level::info : spdlog::level::warn, "{}", scene::format(message));
  }
}

}  // namespace hexaplast::runner
