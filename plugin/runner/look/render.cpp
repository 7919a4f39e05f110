// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "picture/film.hpp"
#include "picture/gallery.hpp"
#include "picture/png_file.hpp"
#include "picture/section_page.hpp"
#include "record/files.hpp"
#include "record/manifest.hpp"
#include "record/recorded_run.hpp"
#include "runner/command.hpp"
#include "runner/run/common_options.hpp"
#include "runner/run/progress.hpp"
#include "runner/run/staging.hpp"
#include "runner/subcommand.hpp"

namespace hexaplast::runner {
namespace {

using output::RecordedRun;

/// `hexaplast render`, as the command line gives it.
struct RenderOptions {
  std::filesystem::path run;  ///< directory of a run, or its .pvd file
  std::filesystem::path out = "render.png";
  std::optional<std::filesystem::path> video;  ///< film of all states, instead of one picture
  std::optional<double> time;                  ///< [s] the state nearest to it; otherwise the last one
  std::optional<long> step;
  PictureOptions pictures;
  std::string range, view, camera, size, slice, sections;  ///< see add_render; empty: not given
  std::string shape = "current";
  std::string ghost = "initial";
  std::string show;  ///< surfaces, hexahedra or both; empty: as the scene says
  bool no_edges = false;
  bool no_marks = false;
};

constexpr int kMinSize = 64, kMaxSize = 4096;  // [pixels]
constexpr int kMaxSections = 100;
constexpr int kMaxDecimals = 6;  // of times
constexpr const char* kRestShape = "rest shape";

// What options say
// -------------------------------------------------------------------------------------------------------------------

[[noreturn]] void refuse(const char* option, const std::string& text, const char* allowed) {
  throw UsageError(fmt::format("{} {}: must be {}", option, text, allowed));
}

std::optional<Vec3> vector_of(std::string_view text) {
  const std::vector<double> xyz = numbers_in(text, ',');
  if (xyz.size() != 3) return std::nullopt;
  return Vec3(xyz[0], xyz[1], xyz[2]);
}

std::optional<std::pair<double, double>> range_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::vector<double> ends = numbers_in(text, ':');
  if (ends.size() != 2 || !(ends[0] < ends[1]) || !std::isfinite(ends[1] - ends[0]))
    refuse("--range", text, "two numbers LO:HI, the lesser first");
  return std::pair(ends[0], ends[1]);
}

std::pair<int, int> size_of(const std::string& text) {
  if (text.empty()) return {1280, 720};
  const auto is_size = [](double side) { return side == std::floor(side) && side >= kMinSize && side <= kMaxSize; };
  const std::vector<double> sides = numbers_in(text, 'x');
  if (sides.size() != 2 || !is_size(sides[0]) || !is_size(sides[1]))
    refuse("--size", text, "WIDTHxHEIGHT, each from 64 to 4096 pixels");
  return {static_cast<int>(sides[0]), static_cast<int>(sides[1])};
}

/// "z:0.2" as axis and number.
std::pair<int, double> axis_and_number(const char* option, const std::string& text, const char* allowed) {
  const std::vector<double> number =
      text.size() > 2 && text[1] == ':' ? numbers_in(std::string_view(text).substr(2), ':') : std::vector<double>();
  if (number.size() != 1 || text[0] < 'x' || text[0] > 'z') refuse(option, text, allowed);
  return {text[0] - 'x', number[0]};
}

std::optional<output::Viewpoint> viewpoint_of(const RenderOptions& options, const Vec3& up) {
  if (!options.view.empty()) {
    if (const std::optional<Vec3> side = output::side_named(options.view, up)) return output::Viewpoint{*side, {}, {}};
    const std::optional<Vec3> towards = vector_of(options.view);
    if (!towards || towards->isZero(0))
      refuse("--view", options.view, "front, back, left, right, top, bottom, or a direction X,Y,Z that is not 0,0,0");
    return output::Viewpoint{*towards, {}, {}};
  }
  if (options.camera.empty()) return std::nullopt;
  constexpr const char* kAllowed =
      "X,Y,Z:X,Y,Z:DEG, the camera's place, another one that it looks at, and its field of view between 0 and 180";
  const std::string_view text = options.camera;
  const std::size_t first = text.find(':'), last = text.rfind(':');
  if (first == last) refuse("--camera", options.camera, kAllowed);
  const std::optional<Vec3> position = vector_of(text.substr(0, first)),
                            target = vector_of(text.substr(first + 1, last - first - 1));
  const std::vector<double> angle = numbers_in(text.substr(last + 1), ':');
  if (!position || !target || *position == *target || angle.size() != 1 || !(angle[0] > 0 && angle[0] < 180))
    refuse("--camera", options.camera, kAllowed);
  return output::Viewpoint{*position - *target, {}, output::Viewpoint::Eye{*position, *target, angle[0], true}};
}

const RecordedRun::Entry& chosen(const RecordedRun& run, const RenderOptions& options) {
  const std::vector<RecordedRun::Entry>& entries = run.entries();
  const auto [first, last] = std::ranges::minmax(entries, {}, &RecordedRun::Entry::time);
  if (const double rounding = 1e-5 * last.time;  // of what the message shows
      options.time && !(*options.time >= first.time - rounding && *options.time <= last.time + rounding))
    throw UsageError(fmt::format("--time {}: this run holds {:.6g} to {:.6g} s", *options.time, first.time, last.time));
  if (options.time)
    return *std::ranges::min_element(entries, {},
                                     [&](const auto& entry) { return std::abs(entry.time - *options.time); });
  if (!options.step) return entries.back();
  const auto found = std::ranges::find(entries, options.step, &RecordedRun::Entry::step);
  if (found != entries.end()) return *found;
  std::string steps;
  for (const RecordedRun::Entry& entry : entries)
    if (entry.step) steps += fmt::format("{}{}", steps.empty() ? "" : ", ", *entry.step);
  throw UsageError(fmt::format("--step {}: this run holds {}", *options.step, steps.empty() ? "no numbers" : steps));
}

// What is drawn
// -------------------------------------------------------------------------------------------------------------------

/// A run with what its manifest says of pictures, where there is one.
struct Subject {
  explicit Subject(const std::filesystem::path& place) : run(place), manifest(output::read_manifest(run.directory())) {}

  std::string title() const { return manifest ? manifest->caption() : run.name(); }

  int time_decimals() const {
    if (manifest) return output::time_decimals(manifest->dt);
    // enough to tell the times apart that are there
    for (int decimals = 2; decimals < kMaxDecimals; ++decimals) {
      const double tick = std::pow(10.0, -decimals);
      const auto is_told = [&](const RecordedRun::Entry& entry) {
        return std::abs(entry.time / tick - std::round(entry.time / tick)) < 1e-3;
      };
      if (std::ranges::all_of(run.entries(), is_told)) return decimals;
    }
    return kMaxDecimals;
  }

  RecordedRun run;
  std::optional<output::Manifest> manifest;
};

std::string ghost_name(const RenderOptions& options) {
  if (options.ghost == "none") return "";
  return options.ghost == "rest" ? kRestShape : "initial shape";
}

/// What is shown is the rest shape, which nothing acts on.
bool is_free_of_loads(const RenderOptions& options) { return options.shape == "rest"; }

const PointArray& shown_positions(const RecordedRun::State& state, const RenderOptions& options) {
  return options.shape == "rest" ? state.plastic_rest : state.positions;
}

/// What the options say.
output::Staging staging_of(const RenderOptions& options) {
  output::Staging staging;
  staging.range = range_of(options.range);
  staging.viewpoint = viewpoint_of(options, staging.upright());
  staging.shows_edges = !options.no_edges;
  staging.ghost = ghost_name(options);
  std::tie(staging.width, staging.height) = size_of(options.size);
  if (!options.slice.empty()) {
    const auto [axis, place] = axis_and_number("--slice", options.slice, "an axis and a place on it, as in x:0.05");
    staging.cut = Plane{Vec3::Unit(axis), place};
  }
  return staging;
}

/// What the scene said, and then the options.
output::Staging staging_of(const Subject& subject, const RenderOptions& options) {
  output::Staging staging = staging_of(options);
  if (subject.manifest && subject.manifest->pictures)
    static_cast<output::PictureRecord&>(staging) = *subject.manifest->pictures;
  staging.regions = subject.run.regions();
  stage(options.pictures, staging);
  if (staging.range && staging.shows_numbers())
    throw UsageError(fmt::format("--range {}: regions have no scale", options.range));
  if (const std::optional asked_for = viewpoint_of(options, staging.upright())) staging.viewpoint = asked_for;
  staging.embedded_surfaces = subject.run.embedded_surfaces();
  const std::string& show = options.show;
  if (show == "surfaces" && staging.embedded_surfaces.empty())
    throw UsageError("--show surfaces: this run holds no surface.pvd, its scene shows none");
  if (show == "hexahedra") staging.embedded_surfaces.clear();
  if (!show.empty()) staging.shows_hexahedra = show != "surfaces";
  // where there is no manifest
  if (staging.embedded_surfaces.empty()) staging.shows_hexahedra = true;
  if (options.no_marks || is_free_of_loads(options)) staging.gravity.setZero();
  return staging;
}

void require_met(const Plane& cut, const RecordedRun& run, const RecordedRun::State& state,
                 const RenderOptions& options) {
  const auto [min, max] =
      extent_along(cut.normal, shown_positions(state, options), run.mesh().hexahedra(), state.alive);
  if (cut.offset < min || cut.offset > max)
    throw UsageError(fmt::format("--slice {}: does not meet the body, which lies between {:.6g} and {:.6g} m",
                                 options.slice, min, max));
}

void add(const RecordedRun::Entry& entry, const RecordedRun::State& state, const RenderOptions& options,
         output::Gallery& gallery) {
  const bool shows_marks = !options.no_marks && !is_free_of_loads(options);
  gallery.add(entry.step.value_or(0), entry.time, shown_positions(state, options), state.values, state.alive,
              shows_marks ? state.conditions : output::BoundaryConditions(),
              options.ghost == "rest" ? &state.plastic_rest : nullptr, state.open);
}

void render_film(Subject& subject, const RenderOptions& options, output::Renderer& renderer) {
  RecordedRun& run = subject.run;
  const std::vector<RecordedRun::Entry>& entries = run.entries();
  const double seconds = entries.back().time - entries.front().time;
  if (!(seconds > 0)) throw UsageError("--video: this run holds one state only, or its times do not ascend");
  const output::Staging staging = staging_of(subject, options);
  output::Gallery gallery(run.mesh(), subject.title(), subject.time_decimals(), staging);
  for (const RecordedRun::Entry& entry : entries) add(entry, run.state(entry, staging.quantity), options, gallery);
  output::Film film(*options.video, static_cast<double>(entries.size() - 1) / seconds);
  Progress progress(0, static_cast<long>(entries.size()), true);
  long done = 0;
  gallery.for_each_drawing([&](int, const output::Drawing& drawing) {
    film.add(renderer.render(drawing));
    progress.show(++done, [] { return "pictures"; });
  });
  film.finish();
}

output::Drawing sections_of(const Subject& subject, const RecordedRun::Entry& entry, const RecordedRun::State& state,
                            const output::Staging& staging, const RenderOptions& options) {
  constexpr const char* kAllowed = "an axis and how many sections, from 1 to 100, as in z:5";
  const auto [axis, count] = axis_and_number("--sections", options.sections, kAllowed);
  if (count != std::floor(count) || count < 1 || count > kMaxSections) refuse("--sections", options.sections, kAllowed);
  output::SectionPage page;
  page.title = subject.title();
  page.remark = fmt::format("t = {:.{}f} s", entry.time, subject.time_decimals());
  page.axis = axis;
  page.count = static_cast<int>(count);
  page.up = staging.upright();
  page.quantity = staging.quantity;
  page.regions = staging.regions;
  page.range = range_of(options.range);
  page.shows_edges = !options.no_edges;
  page.ghost = ghost_name(options);
  std::tie(page.width, page.height) = size_of(options.size);
  const HexMesh& mesh = subject.run.mesh();
  return page.drawing(mesh, shown_positions(state, options), state.values, state.alive,
                      options.ghost == "rest" ? state.plastic_rest : mesh.positions());
}

output::Drawing picture_of(Subject& subject, const RenderOptions& options) {
  RecordedRun& run = subject.run;
  const output::Staging staging = staging_of(subject, options);
  const RecordedRun::Entry& entry = chosen(run, options);
  output::Gallery gallery(run.mesh(), subject.title(), subject.time_decimals(), staging);
  const RecordedRun::State state = run.state(entry, staging.quantity);
  if (!options.sections.empty()) return sections_of(subject, entry, state, staging, options);
  if (staging.cut) require_met(*staging.cut, run, state, options);
  add(entry, state, options, gallery);
  output::Drawing picture;
  gallery.for_each_drawing([&](int, const output::Drawing& drawing) { picture = drawing; });
  return picture;
}

/// Makes a picture or a film of a run that is finished. Throws what the modules below throw, and UsageError for options
/// that make no sense, alone or for this run.
void render(const RenderOptions& given) {
  staging_of(given);  // what is wrong with the options is said before anything is read
  RenderOptions options = given;
  std::error_code unknown;
  InputFiles inputs({options.run});
  const std::filesystem::path directory =
      std::filesystem::is_directory(options.run, unknown) ? options.run : options.run.parent_path();
  output::add_files_of_run(directory, inputs);
  std::filesystem::path& place = options.video ? *options.video : options.out;
  place = output_place(place, inputs, {directory});
  Subject subject(options.run);
  const std::unique_ptr<output::Renderer> renderer = output::load_renderer();
  if (options.video) return render_film(subject, options, *renderer);
  output::write_png(options.out, renderer->render(picture_of(subject, options)));
}

}  // namespace

void add_render(CLI::App& app, Call& call) {
  const auto [command, options] =
      add_subcommand(app, call, "render", "Make a picture or a film of a run that is finished", render,
                     [](const RenderOptions& given) { return given.run.string(); });
  add_option(command, "run", options.run, "DIR|PVD", "Directory of the run, or its .pvd file")->required();
  CLI::Option* out = add_option(command, "-o,--out", options.out, "FILE", "PNG file to write; replaces an older one")
                         ->capture_default_str();
  CLI::Option* time = add_option(command, "--time", options.time, "T",
                                 "The state nearest to this time [s] of the run; otherwise the last one");
  CLI::Option* step = add_option(command, "--step", options.step, "N", "The state after this step")->excludes(time);
  const std::vector<CLI::Option*> pictures = add_pictures(command, options.pictures);
  add_option(command, "--range", options.range, "LO:HI",
             "Values at the ends of the colour bar; otherwise those that are shown");
  CLI::Option* view = add_option(command, "--view", options.view, "SIDE|X,Y,Z",
                                 "Where the viewer stands: front, back, left, right, top, bottom, or a direction");
  CLI::Option* camera =
      add_option(command, "--camera", options.camera, "X,Y,Z:X,Y,Z:DEG",
                 "Picture in perspective: where the camera stands [m], what it looks at [m], angle from the lower "
                 "to the upper border [deg]")
          ->excludes(view);
  add_option(command, "--size", options.size, "WxH", "Of the picture [pixels]. Default 1280x720");
  CLI::Option* slice = add_option(command, "--slice", options.slice, "AXIS:X",
                                  "Cut the body through at a place on an axis [m] and leave the viewer's side out");
  CLI::Option* sections = add_option(command, "--sections", options.sections, "AXIS:N",
                                     "Instead of the body, so many sections across an axis, side by side")
                              ->excludes(slice)
                              ->excludes(pictures[1])
                              ->excludes(view)
                              ->excludes(camera);
  add_choice(command, "--shape", options.shape, {"current", "rest"},
             "The current shape of the body, or its rest shape, without loads");
  add_choice(command, "--ghost", options.ghost, {"initial", "rest", "none"}, "Pale shape behind the body");
  add_option(command, "--show", options.show, "surfaces|hexahedra|both",
             "Surfaces that the hexahedra carry, the hexahedra, or surfaces and edges of hexahedra. Default: as the "
             "scene says")
      ->check(CLI::IsMember({"surfaces", "hexahedra", "both"}))
      ->excludes(sections);
  command.add_flag("--no-edges", options.no_edges, "Leave out the edges of hexahedra");
  command.add_flag("--no-marks", options.no_marks, "Leave out fixed nodes, springs, loads, instruments and gravity");
  add_video(command, options.video, "Film of all states in real time instead of a picture: .png, animated")
      ->excludes(out)
      ->excludes(time)
      ->excludes(step)
      ->excludes(sections);
}

}  // namespace hexaplast::runner
