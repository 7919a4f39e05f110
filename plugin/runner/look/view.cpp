// SPDX-License-Identifier: LGPL-2.1-or-later
#include <dlfcn.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "formats/text.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "record/manifest.hpp"
#include "record/recorder.hpp"
#include "runner/command.hpp"
#include "runner/process.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/results.hpp"
#include "runner/run/simulation.hpp"
#include "runner/run/staging.hpp"
#include "runner/subcommand.hpp"
#include "scene/reader.hpp"
#include "view/recording.hpp"
#include "view/shown_scene.hpp"
#include "view/window.hpp"

namespace hexaplast::runner {
namespace {

using std::filesystem::path;

/// `hexaplast view`, as the command line gives it.
struct ViewOptions {
  SceneOptions scene;
  PictureOptions pictures;
  bool is_running = false;                           ///< from the beginning
  bool is_free = false;                              ///< as fast as it goes, instead of real time
  double speed = 1;                                  ///< in real time
  std::optional<long> steps;                         ///< after which the window closes
  std::filesystem::path picture_folder = ".";        ///< where those go that are taken by hand
  std::optional<std::filesystem::path> picture;      ///< of the window's last moment
  std::optional<std::filesystem::path> final_state;  ///< JSON of the last state
  std::optional<std::filesystem::path> record;       ///< scene that repeats what was done
  std::optional<int> threads;
  int width = 1440, height = 860;  ///< [pixels]
};

/// The window's code, loaded from its place beside the installed libraries.
view::ShowWindow load_window() {
  const std::string_view missing = HEXAPLAST_WINDOW_MISSING;
  const auto refuse = [](const std::string& what) -> scene::PluginError {
    return scene::PluginError(scene::format_error({"hexaplast view", 0}, what));
  };
  if (!missing.empty())
    throw refuse(fmt::format("this hexaplast was built without the live window: missing at build time: {}", missing));
  const path file = (std::filesystem::read_symlink("/proc/self/exe").parent_path() / HEXAPLAST_LIB_FROM_BIN /
                     "hexaplast" / "hexaplast_window.so")
                        .lexically_normal();
  // stays loaded for the life of the process, as graphics drivers do
  void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!module) throw refuse(fmt::format("the window cannot be loaded: {}", ::dlerror()));
  void* symbol = ::dlsym(module, HEXAPLAST_WINDOW_ENTRY);
  if (!symbol) throw refuse(file.string() + " belongs to another version of Hexaplast");
  return reinterpret_cast<view::ShowWindow>(symbol);
}

std::unique_ptr<scene::Component> make_component(std::string_view class_name) {
  scene::Factory factory;
  load_components(factory);
  return factory.make(class_name);
}

/// The elements of the scene's file, its includes carried out.
scene::Element document_of(const SceneOptions& options, scene::Scene& scene) {
  scene::Diagnostics diagnostics;
  return scene::read_document(scene::read_scene_file(options.file), options.file, diagnostics, nullptr,
                              scene.root().files().search);
}

/// Throws UsageError for a directory of a finished run, and for a .pvd file in one.
void require_scene(const path& file) {
  const path directory = file.extension() == ".pvd" ? file.parent_path() : file;
  std::error_code unknown;
  if (std::filesystem::exists(directory / output::kManifestName, unknown))
    throw UsageError(fmt::format("{} is a finished run, not a scene: open {} in a browser, or use hexaplast render",
                                 file.string(), (directory / "report.html").string()));
}

/// Shows a scene in a window until that is closed, and prints what became of it. Throws PluginError where the window is
/// not part of the build or cannot be loaded, OutputError where none can be opened, NumericalError where it was closed
/// on a step that failed, and what the modules below throw.
int view(const ViewOptions& options) {
  require_scene(options.scene.file);
  const view::ShowWindow show = load_window();
  if (options.threads) set_num_threads(*options.threads);
  watch_signals();
  Simulation simulation(options.scene);
  const InputFiles& inputs = simulation.scene().root().files().inputs;
  std::optional<path> picture;
  if (options.picture) picture = output_place(*options.picture, inputs);
  std::optional<output::WholeFile> final_state;
  if (options.final_state) final_state.emplace(output_place(*options.final_state, inputs));
  // as it is now: somebody may edit it while the window is open
  std::optional<scene::Element> document;
  std::optional<output::WholeFile> record;
  std::optional<path> record_place;
  if (options.record) {
    document = document_of(options.scene, simulation.scene());
    record_place = output_place(*options.record, inputs);
    record.emplace(*record_place);
  }
  output::Staging staging = view::staging_of(simulation.shown());
  stage(options.pictures, staging);
  view::Session session({.title = options.scene.file.stem().string(),
                         .scene = simulation.scene(),
                         .step = [&]() -> const output::StepRecord& { return simulation.step(); },
                         .reset = [&] { simulation.reset(); },
                         .serialize = [&](Archive& archive) { simulation.serialize(archive); },
                         .conditions = [&] { return view::conditions_of(simulation.shown()); }},
                        make_component);
  const std::span<const output::Bodies::Entry> bodies = simulation.bodies()->all();
  std::vector<output::ProbeRecord> probes;
  for (scene::Probe* probe : simulation.probes()) probes.push_back({probe->name(), std::string(probe->unit())});
  view::WindowCall call{.session = session,
                        .staging = std::move(staging),
                        .bodies = {bodies.begin(), bodies.end()},
                        .probes = std::move(probes),
                        .options = {.width = options.width,
                                    .height = options.height,
                                    .is_running = options.is_running,
                                    .pace = options.is_free ? view::Pace::kFree : view::Pace::kRealTime,
                                    .speed = options.speed,
                                    .picture_folder = options.picture_folder,
                                    .steps = options.steps,
                                    .picture = picture},
                        .is_asked_to_end = [] { return requested_signal() != 0; }};
  show(call);
  session.stop();
  if (record) {
    record->write(view::recorded_scene(simulation.scene(), std::move(*document), options.scene.overrides,
                                       session.actions(), record_place->parent_path()));
    record->commit();
  }
  if (!session.failure().empty()) throw NumericalError(session.failure());

  if (final_state)
    output::write_final(*final_state, simulation.time(), simulation.positions(), simulation.velocities(),
                        *simulation.bodies(), simulation.state_hash());
  print_summary(simulation, options.scene.file);
  const int signal = requested_signal();
  return signal == 0 ? kOk : kSignalled + signal;
}

}  // namespace

void add_view(CLI::App& app, Call& call) {
  const auto [command, options] =
      add_subcommand(app, call, "view", "Run a scene in a window, and pull and push at it with the mouse", view,
                     [](const ViewOptions& given) { return given.scene.file.string(); });
  add_scene(command, options.scene);
  add_pictures(command, options.pictures);
  command.add_flag("--run", options.is_running, "Run from the beginning; otherwise the scene waits for Space");
  add_option(command, "--speed", options.speed, "F",
             "Seconds of the simulation per second of the clock; default 1: real time")
      ->check(CLI::Range(0.001, 1000.0));
  command.add_flag("--free", options.is_free, "As fast as it goes, not in real time");
  CLI::Option* steps =
      add_steps(command, options.steps, "Run so many time steps as fast as they go, then close the window");
  add_option(command, "--picture", options.picture, "FILE.png", "Write a picture of the window when --steps are done")
      ->needs(steps);
  add_option(command, "--pictures", options.picture_folder, "DIR", "Directory for the pictures that are taken by hand")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  add_final_state(command, options.final_state);
  add_option(command, "--record", options.record, "FILE.scn",
             "Write a scene that repeats, without the window, what was done in it: with hexaplast run");
  add_threads(command, options.threads);
  add_option(command, "--width", options.width, "N", "Width of the window [pixels]")
      ->check(CLI::Range(800, 16'000))
      ->capture_default_str();
  add_option(command, "--height", options.height, "N", "Height of the window [pixels]")
      ->check(CLI::Range(500, 16'000))
      ->capture_default_str();
}

}  // namespace hexaplast::runner
