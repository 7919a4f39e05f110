// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "formats/line_file.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "picture/film.hpp"
#include "picture/png_file.hpp"
#include "record/conditions_vtu.hpp"
#include "record/surface_vtu.hpp"
#include "record/time_series.hpp"
#include "record/viewer_states.hpp"
#include "record/vtu.hpp"

namespace hexaplast::output {
namespace fs = std::filesystem;
namespace {

/// What a row of history.csv holds, and the names of it.
using Columns = std::vector<std::pair<std::string, double>>;

/// The steps that are drawn: `count` of them, evenly over the run, ascending, the last step among them.
std::vector<long> steps_to_draw(long num_steps, int count) {
  std::vector<long> steps;
  for (int i = 1; i <= count; ++i) steps.push_back(std::lround(static_cast<double>(num_steps) * i / count));
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  return steps;
}

constexpr double kFilmRate = 25;  // [1/s] pictures of a film

/// The steps that a film shows: the first state, and then at most kFilmRate states a second; ascending.
std::vector<long> steps_to_film(long num_steps, double dt) {
  std::vector<long> steps;
  const double stride = std::max(1.0, 1 / (kFilmRate * dt));
  for (long i = 0; std::lround(static_cast<double>(i) * stride) <= num_steps; ++i)
    steps.push_back(std::lround(static_cast<double>(i) * stride));
  return steps;
}

std::unique_ptr<Film> film_of(const RunPlan& plan) {
  return plan.video.empty() ? nullptr : std::make_unique<Film>(plan.video, std::min(kFilmRate, 1 / plan.dt));
}

double mean_displacement(const std::vector<int>& nodes, ConstPoints from, ConstPoints to) {
  double sum = 0;
  for (const int node : nodes) sum += (to.row(node) - from.row(node)).norm();
  return nodes.empty() ? 0 : sum / static_cast<double>(nodes.size());
}

constexpr std::string_view kMesh = "mesh_", kSurface = "surface_", kInstruments = "instruments_", kSprings = "springs_";

std::string vtu_name(std::string_view prefix, long step) { return fmt::format("{}{:06}.vtu", prefix, step); }

/// opened.csv of a run that is saved; absent: it has none.
std::optional<LineFile> saved_openings(const fs::path& directory, Archive& saved) {
  unsigned char has_openings = 0;
  saved(has_openings);
  if (has_openings == 0) return std::nullopt;
  return std::optional<LineFile>(std::in_place, directory / "opened.csv", saved);
}

fs::path prepared(fs::path directory, const RunPlan& plan) {
  prepare_directory(directory, plan.force, plan.inputs);
  return directory;
}

}  // namespace

struct Recorder::Files {
  Files(fs::path where, Bodies of, RunPlan run, RendererSource source)
      : plan(std::move(run)),
        film(film_of(plan)),
        directory(prepared(std::move(where), plan)),
        bodies(std::move(of)),
        renderer(std::move(source)),
        measurement(bodies),
        history(directory / "history.csv"),
        removed(directory / "removed.csv"),
        meshes(directory / "mesh.pvd"),
        embedded_surfaces(bodies.mesh(), plan.staging.embedded_surfaces),
        to_draw(steps_to_draw(plan.num_steps, plan.num_frames)) {
    if (film) to_film = steps_to_film(plan.num_steps, plan.dt);
    StepRecord none{.probes = std::vector<double>(plan.probes.size())};
    if (plan.has_energy_balance) none.energy.emplace();
    std::vector<std::string> names;
    for (auto& [name, value] : columns(none, bodies.mesh().positions())) names.push_back(std::move(name));
    history.append(fmt::format("{}", fmt::join(names, ",")));
    const char* const body = bodies.is_one() ? "" : ",body";
    removed.append(fmt::format("step,time,hexahedron{}", body));
    if (plan.has_openings) {
      opened.emplace(directory / "opened.csv");
      opened->append(fmt::format("step,time,hexahedra{}", body));
    }
    open_companions();
    open_gallery();
  }

  Files(fs::path where, Bodies of, RunPlan run, Archive& saved, RendererSource source)
      : plan(std::move(run)),
        directory(std::move(where)),
        bodies(std::move(of)),
        renderer(std::move(source)),
        measurement(bodies),
        history(directory / "history.csv", saved),
        removed(directory / "removed.csv", saved),
        opened(saved_openings(directory, saved)),
        meshes(directory / "mesh.pvd"),
        embedded_surfaces(bodies.mesh(), plan.staging.embedded_surfaces),
        to_draw(steps_to_draw(plan.num_steps, plan.num_frames)) {
    long step = 0;
    meshes.serialize(saved);
    saved(step, step_on_disk);
    for (std::size_t& count : num_removed) saved(count);
    for (std::size_t& count : num_opened) saved(count);
    const auto is_there = [&](const std::string& vtu) {
      std::error_code error;
      if (fs::is_regular_file(directory / vtu, error)) return true;
      lost.push_back(vtu);
      return false;
    };
    // the last state of a run that was to be shorter is none that this one writes
    meshes.keep([&](const std::string& vtu) { return wants_state(number_at_end(vtu).value_or(0)) && is_there(vtu); });
    open_companions();
    for (std::optional<TimeSeries>* series : {&surfaces, &instruments, &springs})
      if (*series) (*series)->keep(is_there);
    prepare_to_go_on(directory, step, plan.inputs, [&](const std::string& name) {
      return name.ends_with(".vtu") && meshes.has(vtu_name(kMesh, number_at_end(name).value_or(0)));
    });
    history.cut();
    removed.cut();
    if (opened) opened->cut();
    open_gallery();
  }

  RunPlan plan;
  std::unique_ptr<Film> film;  // null: none wanted; before anything is written, since it may be refused
  fs::path directory;
  Bodies bodies;
  RendererSource renderer;
  Measurement measurement;
  LineFile history, removed;
  std::optional<LineFile> opened;  // absent: nothing opens
  TimeSeries meshes;
  std::optional<TimeSeries> surfaces, instruments, springs;  // of the same steps; absent: there are none
  std::vector<std::string> lost;                             // .vtu files that had gone
  CarriedSurfaces embedded_surfaces;
  std::vector<long> to_draw, to_film;  // ascending
  std::optional<Gallery> gallery;      // absent: no pictures wanted
  std::optional<ViewerStates> viewer;  // absent: not wanted

  // the latest state, so that a run that ends early still shows where it ended
  StepRecord latest;
  PointArray latest_positions, latest_velocities;
  BoundaryConditions latest_conditions;
  long step_on_disk = -1;  // of the latest .vtu
  // hexahedra that removed.csv lists, and joints that opened.csv lists, of each body
  std::vector<std::size_t> num_removed = std::vector<std::size_t>(bodies.all().size()), num_opened = num_removed;
  bool finished = false;

  void open_gallery() {
    if (plan.has_viewer) viewer.emplace(bodies, plan.title, plan.num_steps, plan.dt, plan.staging);
    if (plan.num_frames > 0 || film) gallery.emplace(bodies.mesh(), plan.title, time_decimals(plan.dt), plan.staging);
  }
  void open_companions() {
    if (!embedded_surfaces.empty()) surfaces = meshes.with_prefix(directory / "surface.pvd", kMesh, kSurface);
    if (plan.has_instruments) instruments = meshes.with_prefix(directory / "instruments.pvd", kMesh, kInstruments);
    if (plan.has_springs) springs = meshes.with_prefix(directory / "springs.pvd", kMesh, kSprings);
  }
  bool wants_state(long step) const { return step % std::max(plan.output_every, 1) == 0 || step == plan.num_steps; }
  void append_removed(const StepRecord& record);
  void append_opened(const StepRecord& record);
  template <class List, class Describe>
  void append_new(const StepRecord& record, LineFile& file, std::vector<std::size_t>& num_listed, const List& list,
                  const Describe& describe);
  Columns columns(const StepRecord& record, ConstPoints positions) const;
  std::string row_of(const StepRecord& record, ConstPoints positions) const;
  void write_state();
  bool is_drawn(long step) const { return std::ranges::binary_search(to_draw, step); }
  bool is_filmed(long step) const { return std::ranges::binary_search(to_film, step); }
  void keep_for_viewer();
  void write_viewer();
  void keep_for_picture();
  std::vector<std::string> draw_pictures();
};

Recorder::Recorder(fs::path directory, Bodies bodies, RunPlan plan, RendererSource renderer)
    : files_(std::make_unique<Files>(std::move(directory), std::move(bodies), std::move(plan), std::move(renderer))) {}

Recorder::Recorder(fs::path directory, Bodies bodies, RunPlan plan, Archive& saved, RendererSource renderer)
    : files_(std::make_unique<Files>(std::move(directory), std::move(bodies), std::move(plan), saved,
                                     std::move(renderer))) {}

Recorder::~Recorder() = default;

const std::vector<std::string>& Recorder::lost_states() const { return files_->lost; }

void Recorder::save(Archive& archive) {
  Files& files = *files_;
  files.history.save(archive);
  files.removed.save(archive);
  unsigned char has_openings = files.opened.has_value();
  archive(has_openings);
  if (files.opened) files.opened->save(archive);
  files.meshes.serialize(archive);
  archive(files.latest.step, files.step_on_disk);
  for (std::size_t& count : files.num_removed) archive(count);
  for (std::size_t& count : files.num_opened) archive(count);
}

void Recorder::record(const StepRecord& record, ConstPoints positions, ConstPoints velocities,
                      BoundaryConditions conditions) {
  Files& files = *files_;
  const std::string row = files.row_of(record, positions);  // before anything changes: it may be refused
  files.latest = record;
  files.latest_positions = positions;
  files.latest_velocities = velocities;
  files.latest_conditions = std::move(conditions);

  files.append_removed(record);  // first: what history.csv counts is listed
  if (files.opened) files.append_opened(record);
  files.history.append(row);
  if (files.wants_state(record.step)) files.write_state();
  if (files.viewer && files.viewer->wants(record.step)) files.keep_for_viewer();
  if (files.is_drawn(record.step) || files.is_filmed(record.step)) files.keep_for_picture();
}

std::vector<std::string> Recorder::finish() {
  Files& files = *files_;
  if (files.finished || files.latest_positions.rows() == 0) return {};
  files.finished = true;
  if (files.step_on_disk != files.latest.step) files.write_state();

  if (files.viewer) files.write_viewer();
  if (!files.gallery) return {};
  const int drawn = files.gallery->num_states();
  if (drawn == 0 || files.gallery->step(drawn - 1) != files.latest.step) files.keep_for_picture();
  return files.draw_pictures();
}

void Recorder::Files::append_removed(const StepRecord& record) {
  append_new(
      record, removed, num_removed, [](const Body& body) { return body.removed(); },
      [](const Body&, int hexahedron) { return hexahedron; });
}

void Recorder::Files::append_opened(const StepRecord& record) {
  append_new(
      record, *opened, num_opened, [](const Body& body) { return body.opened(); },
      [](const Body& body, int joint) { return fmt::join(body.joints().hexahedra(joint), " "); });
}

// All rows of a step at once: thousands of hexahedra may go together.
template <class List, class Describe>
void Recorder::Files::append_new(const StepRecord& record, LineFile& file, std::vector<std::size_t>& num_listed,
                                 const List& list, const Describe& describe) {
  std::string rows;
  for (std::size_t i = 0; i < num_listed.size(); ++i) {
    const Bodies::Entry& entry = bodies.all()[i];
    const std::span<const int> all = list(*entry.body);
    for (; num_listed[i] < all.size(); ++num_listed[i])
      rows += fmt::format("{}{},{},{}{}", rows.empty() ? "" : "\n", record.step, record.time,
                          describe(*entry.body, all[num_listed[i]]), bodies.is_one() ? "" : "," + entry.name);
  }
  if (!rows.empty()) file.append(rows);
}

Columns Recorder::Files::columns(const StepRecord& record, ConstPoints positions) const {
  const Measures measures =
      plan.has_plastic_ends ? measurement.measure(positions) : measurement.measure_current(positions);
  Columns all = {{"step", record.step},
                 {"time", record.time},
                 {"kinetic_energy", record.kinetic_energy},
                 {"elastic_energy", record.energy ? record.energy->elastic : bodies.energy(positions)},
                 {"dissipated_energy", bodies.dissipated_energy()},
                 {"current_volume_ratio", measures.current_volume_ratio},
                 {"plastic_rest_volume_ratio", measures.plastic_rest_volume_ratio}};
  const auto add = [&](Columns more) { std::ranges::move(more, std::back_inserter(all)); };
  if (plan.has_plastic_ends)
    add({{"plastic_elongation", measures.plastic_elongation}, {"plastic_twist_deg", measures.plastic_twist_deg}});
  add({{"end_displacement", mean_displacement(plan.loaded_nodes, bodies.mesh().positions(), positions)},
       {"yielded", record.flow.yielded},
       {"inverted", record.flow.inverted},
       {"removed", bodies.num_removed()},
       {"solver_iterations", record.solver_iterations},
       {"residual", record.residual},
       {"step_ms", record.step_ms},
       {"rolled_back", record.flow.rolled_back}});
  if (plan.has_openings)
    add({{"opened", bodies.num_opened()}, {"pieces", connected_parts(bodies.mesh(), bodies.alive()).count}});
  if (plan.has_ends)
    add({{"current_elongation", measures.current_elongation}, {"current_twist_deg", measures.current_twist_deg}});
  if (plan.has_energy_balance) {
    const EnergyBalance& energy = *record.energy;
    add({{"load_work", energy.load_work},
         {"support_work", energy.support_work},
         {"damping_loss", energy.damping_loss},
         {"numerical_loss", energy.numerical_loss},
         {"recovery_work", energy.recovery_work},
         {"change_work", energy.change_work},
         {"flow_loss", energy.flow_loss},
         {"energy_error", energy.error()}});
    if (plan.has_contact)
      add({{"instrument_work", record.instrument_work},
           {"contact_energy", record.contact_energy},
           {"friction_loss", record.friction_loss}});
  }
  for (std::size_t p = 0; p < record.probes.size(); ++p)
    all.emplace_back(probe_column(plan.probes[p]), record.probes[p]);
  return all;
}

std::string Recorder::Files::row_of(const StepRecord& record, ConstPoints positions) const {
  std::vector<double> row;
  for (const auto& [name, value] : columns(record, positions)) {
    if (!std::isfinite(value)) throw NumericalError(fmt::format("step {}: the {} is not finite", record.step, name));
    row.push_back(value);
  }
  return fmt::format("{}", fmt::join(row, ","));
}

// The mesh last: whatever mesh.pvd names has its companions.
void Recorder::Files::write_state() {
  ElementFields fields = bodies.fields(latest_positions);
  const std::span<const unsigned char> alive = bodies.alive();
  const auto write = [&](TimeSeries& series, std::string_view prefix, const auto& write_file) {
    const std::string name = vtu_name(prefix, latest.step);
    write_file(directory / name);
    series.add(latest.time, name);
  };
  if (surfaces) {
    const std::vector<double> strains = nodal_means(bodies.mesh(), fields.plastic_strain, alive);
    write(*surfaces, kSurface, [&](const fs::path& file) {
      embedded_surfaces.write(file, bodies.mesh(), latest_positions, strains, alive, bodies.open_faces().get());
    });
  }
  if (instruments)
    write(*instruments, kInstruments,
          [&](const fs::path& file) { write_instruments(file, latest_conditions.instruments, latest_positions); });
  if (springs) write(*springs, kSprings, [&](const fs::path& file) { write_springs(file, latest_conditions.springs); });
  write(meshes, kMesh, [&](const fs::path& file) {
    write_vtu(file, bodies, latest_positions, latest_velocities, std::move(fields), latest_conditions,
              plan.staging.regions);
  });
  step_on_disk = latest.step;
}

void Recorder::Files::keep_for_viewer() {
  viewer->add(latest.step, latest.time, latest_positions, latest_velocities, latest_conditions);
}

void Recorder::Files::write_viewer() {
  if (!viewer->has(latest.step)) keep_for_viewer();
  WholeFile file(directory / kViewerName);
  file.write(viewer->json());
  file.commit();
}

void Recorder::Files::keep_for_picture() {
  gallery->add(latest.step, latest.time, latest_positions,
               values_of(plan.staging.quantity, bodies, latest_positions, latest_velocities, plan.staging.regions),
               bodies.alive(), latest_conditions, nullptr, bodies.open_faces());
}

std::vector<std::string> Recorder::Files::draw_pictures() {
  const fs::path frames = directory / "frames";
  std::error_code error;
  if (plan.num_frames > 0) fs::create_directory(frames, error);
  if (error) throw OutputError(fmt::format("{}: cannot be created: {}", frames.string(), error.message()));
  try {
    const std::unique_ptr<Renderer> draw = renderer();
    gallery->for_each_drawing([&](int state, const Drawing& drawing) {
      const long step = gallery->step(state);
      const Image image = draw->render(drawing);
      const bool is_last = state == gallery->num_states() - 1;
      if (plan.num_frames > 0 && (is_drawn(step) || is_last))
        write_png(frames / fmt::format("frame_{:06}.png", step), image);
      if (film && (is_filmed(step) || is_last)) film->add(image);
    });
  } catch (const RendererUnavailable& reason) {
    if (film) throw OutputError(fmt::format("{}: no film: {}", plan.video.string(), reason.what()));
    return {fmt::format("no pictures: {}", reason.what())};
  }
  if (film) film->finish();
  return {};
}

std::string probe_column(std::string_view probe) {
  return fmt::format("{}{}", probe.starts_with("probe_") ? "" : "probe_", probe);
}

void require_saved_files(const fs::path& directory, Archive& saved) {
  const LineFile history(directory / "history.csv", saved), removed(directory / "removed.csv", saved);
  const std::optional<LineFile> opened = saved_openings(directory, saved);
}

Summary summarise(const Bodies& bodies, ConstPoints positions) {
  const ElementFields fields = bodies.fields(positions);
  Summary summary{Measurement(bodies).measure(positions)};
  const std::span<const unsigned char> alive = bodies.alive();
  summary.num_pieces = connected_parts(bodies.mesh(), alive).count;
  for (std::size_t e = 0; e < alive.size(); ++e)
    if (alive[e])
      summary.worst_element_volume_error =
          std::max(summary.worst_element_volume_error, std::abs(fields.volume_ratio[e] - 1));

  const auto largest = [&](const std::vector<double>& values) {
    Largest found;
    for (std::size_t e = 0; e < alive.size(); ++e)
      if (alive[e] && (found.hexahedron < 0 || values[e] > found.value)) {
        found.value = values[e];
        found.hexahedron = static_cast<int>(e);
      }
    if (found.hexahedron >= 0)
      found.place = gather(positions, bodies.mesh().hexahedra()[found.hexahedron]).colwise().mean().transpose();
    return found;
  };
  summary.strain = largest(fields.strain);
  summary.plastic_strain = largest(fields.plastic_strain);
  return summary;
}

}  // namespace hexaplast::output
