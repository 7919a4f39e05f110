// SPDX-License-Identifier: LGPL-2.1-or-later
#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>

#include "body.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/moving_body.hpp"
#include "instrument.hpp"
#include "motion_record.hpp"
#include "page/html.hpp"
#include "picture.hpp"
#include "record/checkpoint.hpp"
#include "record/files.hpp"
#include "record/recorder.hpp"
#include "record/viewer_states.hpp"
#include "scene/changes.hpp"
#include "scene/identity.hpp"
#include "scene/parts.hpp"
#include "scene/reader.hpp"
#include "scene/visuals.hpp"
#include "values.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::python {
namespace {

using std::filesystem::path;

/// The plugins that were installed together with this module.
path installed_plugins() {
  Dl_info module;
  if (dladdr(reinterpret_cast<void*>(&add_scene), &module) == 0) return {};
  return (std::filesystem::canonical(module.dli_fname).parent_path() / HEXAPLAST_PLUGINS_FROM_MODULE)
      .lexically_normal();
}

std::vector<std::string> assignments_from(const py::dict& overrides) {
  std::vector<std::string> assignments;
  for (const auto& [attribute, value] : overrides)
    assignments.push_back(py::str(attribute).cast<std::string>() + "=" + scene_text("overrides", value));
  return assignments;
}

/// What the scene's components have remarked, as Python's warnings.
void warn(scene::Scene& scene) {
  for (const scene::Message& message : scene.diagnostics().take_warnings())
    if (PyErr_WarnEx(PyExc_UserWarning, scene::format(message).c_str(), 1) != 0) throw py::error_already_set();
}

/// What `read` returns.
template <class Read>
auto checked(const Read& read) {
  try {
    return read();
  } catch (const scene::Rejection& rejection) {
    throw scene::SceneError(rejection.what());
  }
}

/// One of the bodies of a scene, with its state.
class SceneBody final : public BodyState {
 public:
  SceneBody(const std::shared_ptr<scene::Scene>& scene, const scene::SceneBody& of,
            std::shared_ptr<std::atomic_flag> taken)
      : BodyState(std::shared_ptr<const hexaplast::Body>(scene, of.field->body()), std::move(taken)),
        name_(of.name),
        field_(of.field),
        state_(of.state) {}

  const std::string& name() const { return name_; }
  scene::ForceField& field() { return *field_; }
  const PointArray& positions() { return state_->positions(); }
  py::array shown_positions() { return shown_positions_.view(state_->positions()); }
  py::array shown_velocities() { return shown_velocities_.view(state_->velocities()); }

  void refresh() {
    BodyState::refresh();
    shown_positions_.refresh(state_->positions());
    shown_velocities_.refresh(state_->velocities());
  }

 private:
  std::string name_;
  scene::ForceField* field_;
  scene::MechanicalState* state_;
  ShownField shown_positions_, shown_velocities_;
};

/// What a scene is read from.
struct Source {
  path file;
  std::vector<std::string> assignments, plugins;
  std::vector<path> plugin_path, mesh_path;

  /// The same in any working directory.
  py::tuple state() const {
    const auto absolute = [](std::vector<path> all) {
      for (path& one : all) one = std::filesystem::absolute(one);
      return all;
    };
    return py::make_tuple(std::filesystem::absolute(file), assignments, plugins, absolute(plugin_path),
                          absolute(mesh_path));
  }
  static Source from(const py::tuple& state) {
    using Texts = std::vector<std::string>;
    using Paths = std::vector<path>;
    return {state[0].cast<path>(), state[1].cast<Texts>(), state[2].cast<Texts>(), state[3].cast<Paths>(),
            state[4].cast<Paths>()};
  }
};

/// A scene in motion, as `hexaplast run` has it.
class Scene {
 public:
  explicit Scene(const Source& source)
      : source_(source.state()),
        scene_(std::make_shared<scene::Scene>(read(source))),
        identity_(scene::identity_of(*scene_)),
        states_(scene::moving_states(*scene_)),
        shown_states_(scene::shown_states(*scene_)),
        solvers_(scene::integrators_of(*scene_)),
        scene_bodies_(scene::bodies_of(*scene_)),
        title_(source.file.stem().string()) {
    // the arrays of a body keep the whole scene alive
    for (const scene::SceneBody& of : scene_bodies_) {
      entries_.push_back({.name = of.name, .body = of.field->body()});
      bodies_.push_back(std::make_shared<SceneBody>(scene_, of, taken_));
    }
    refresh();
    if (scene::Component* settings = scene::find_settings(*scene_); settings && settings->is_given("steps"))
      planned_steps_ = settings->integer("steps");
    warn(*scene_);
  }

  RunReport step() {
    const Turn turn(taken());
    RunReport report;
    advance(report);
    return report;
  }

  RunReport run(std::optional<long> steps) {
    if (!steps && !planned_steps_)
      throw InputError("the number of steps is not given: neither here nor by RunSettings.steps in the scene");
    if (steps && *steps < 1) throw InputError(fmt::format("steps = {} must be at least 1", *steps));
    const long end = steps ? num_steps_ + *steps : *planned_steps_;
    const Turn turn(taken());
    RunReport report;
    while (num_steps_ < end) {
      advance(report);
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
    return report;
  }

  void open(SceneBody& body, const std::vector<int>& joints) {
    if (std::ranges::find(bodies_, &body, &std::shared_ptr<SceneBody>::get) == bodies_.end())
      throw InputError("the body is another scene's");
    scene_->open(body.field(), joints);
    refresh();
    warn(*scene_);
  }

  void reset() {
    const Turn turn(taken());
    changes_.put_back();
    scene_->reset();
    num_steps_ = 0;
    load_time_ = 0;
    refresh();
    if (record_) begin_record();
  }

  py::bytes save() {
    std::string bytes;
    const output::CheckpointSection sections[] = {
        {"scene", [&](Archive& archive) { serialize(archive); }},
        {"changes", [&](Archive& archive) { changes_.serialize(archive); }},
    };
    output::write_checkpoint(
        [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }, identity_,
        sections);
    return bytes;
  }

  void load(const std::string_view data) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(data));
    const output::Checkpoint saved("the saved state", {bytes.begin(), bytes.end()});
    if (saved.scene_hash() != identity_) throw InputError("the saved state is of another scene");
    changes_.put_back();
    scene_->reset();
    if (saved.has("changes")) {
      Archive changes = saved.section("changes");
      changes_.serialize(changes);
    }
    Archive archive = saved.section("scene");
    serialize(archive);
    load_time_ = std::max(0.0, time() - dt());
    refresh();
    if (record_) begin_record();
    warn(*scene_);
  }

  py::tuple state() { return py::make_tuple(source_, save()); }

  void set(const std::string& name, const py::object& value) {
    changes_.set(name, value.is_none() ? std::nullopt : std::optional(scene_text("value", value)));
  }

  py::object get(const std::string& name) {
    return checked([&] { return python_value(scene::named_attribute(*scene_, name, "get " + name)); });
  }

  py::object force(const std::string& path) {
    return checked([&] {
      scene::Data& data = scene::named_attribute(*scene_, path + ".force", "force " + path);
      if (data.attribute().access != attributes::Access::kOutput)
        throw InputError(fmt::format("force: {} '{}' has no output 'force'", data.owner().class_name(), path));
      return python_value(data);
    });
  }

  py::dict probes() {
    return checked([&] {
      py::dict values;
      scene::Readings readings;
      for (scene::Probe* probe : scene::probes_of(*scene_)) values[probe->name().c_str()] = probe->read(readings);
      return values;
    });
  }

  scene::Scene& get() { return *scene_; }

  py::array picture(const PictureOptions& options) {
    const Turn turn(taken());
    if (entries_.empty()) throw InputError("the scene has no body");
    const output::Bodies bodies(entries_);
    const view::ShownScene shown{*scene_, &bodies, scene_bodies_, load_time_};
    return picture_of({bodies, title_, dt(), num_steps_, time(), positions(), velocities(), view::conditions_of(shown)},
                      view::staging_of(shown), options);
  }

  void record() {
    const Turn turn(taken());
    begin_record();
  }

  std::string page() {
    const Turn turn(taken());
    const std::shared_ptr<const MotionRecord> shown = record_ ? record_ : new_record();
    return shown->page(num_steps_, positions(), velocities(), {});
  }

  /// Of the bodies, of several those of one behind those of another.
  const PointArray& positions() { return shown_states_.size() == 1 ? shown_states_[0]->positions() : positions_; }
  const PointArray& velocities() { return shown_states_.size() == 1 ? shown_states_[0]->velocities() : velocities_; }
  py::array shown_positions() { return shown_positions_.view(positions()); }
  py::array shown_velocities() { return shown_velocities_.view(velocities()); }
  const std::vector<std::shared_ptr<SceneBody>>& bodies() const { return bodies_; }
  std::shared_ptr<SceneBody> body() const {
    if (bodies_.size() <= 1) return bodies_.empty() ? nullptr : bodies_.front();
    std::vector<std::string> names;
    for (const std::shared_ptr<SceneBody>& one : bodies_) names.push_back(one->name());
    throw InputError(fmt::format("the scene has {} bodies ({}): use bodies", names.size(), fmt::join(names, ", ")));
  }
  double kinetic_energy() const {
    double sum = 0;
    for (const scene::OdeSolver* solver : solvers_) sum += solver->kinetic_energy();
    return sum;
  }
  double elastic_energy() const {
    double sum = 0;
    for (const std::shared_ptr<SceneBody>& one : bodies_) sum += one->body().energy(one->positions());
    return sum;
  }
  std::string state_hash() {
    PointArray x, v;
    return output::state_hash(num_steps_, scene::positions_of(states_, x), scene::velocities_of(states_, v), entries_);
  }
  long num_steps() const { return num_steps_; }
  std::optional<long> planned_steps() const { return planned_steps_; }
  double time() { return scene_->time(); }
  double dt() { return scene_->dt(); }

  std::atomic_flag& taken() { return *taken_; }

 private:
  static scene::Scene read(const Source& source) {
    std::vector<path> plugin_path = source.plugin_path;
    plugin_path.push_back(installed_plugins());
    scene::Factory factory;
    scene::PluginLoader loader(factory, plugin_path);
    loader.load("Hexaplast");  // the stock components, which every scene needs
    for (const std::string& plugin : source.plugins) loader.load(plugin);

    scene::Scene scene = scene::read_scene(source.file, factory, loader, scene::SearchPath(source.mesh_path));
    // a scene with mistakes may lack what an override is meant for: then init reports the mistakes
    if (!scene.diagnostics().has_errors())
      for (const std::string& assignment : source.assignments) scene::override_attribute(scene, assignment);
    try {
      scene.init();
    } catch (const std::exception&) {
      warn(scene);  // that may explain the errors
      throw;
    }
    return scene;
  }

  /// As a checkpoint of a run has it.
  void serialize(Archive& archive) {
    archive(num_steps_);
    scene_->serialize(archive);
  }

  std::shared_ptr<MotionRecord> new_record() {
    return std::make_shared<MotionRecord>(entries_, scene_, title_, dt(), num_steps_);
  }

  void begin_record() {
    record_ = new_record();
    record_->add(num_steps_, positions(), velocities(), {});
  }

  void refresh() {
    if (shown_states_.size() > 1) {
      scene::positions_of(shown_states_, positions_);
      scene::velocities_of(shown_states_, velocities_);
    }
    for (const std::shared_ptr<SceneBody>& one : bodies_) one->refresh();
    shown_positions_.refresh(positions());
    shown_velocities_.refresh(velocities());
  }

  void advance(RunReport& report) {
    try {
      const py::gil_scoped_release others_may_run;
      try {
        const double before = scene_->time();
        const SolveReport solved = scene_->step();
        load_time_ = before;
        report.add(solved, scene::flow_of(scene_bodies_));
      } catch (const NumericalError& error) {
        throw NumericalError(fmt::format("step {}: {}", num_steps_ + 1, error.what()));
      }
      ++num_steps_;
      refresh();
      if (record_ && record_->wants(num_steps_)) record_->add(num_steps_, positions(), velocities(), {});
    } catch (const std::exception&) {
      warn(*scene_);  // that may explain the error
      throw;
    }
    warn(*scene_);
  }

  py::tuple source_;  // as pickle takes it
  std::shared_ptr<scene::Scene> scene_;
  scene::Changes changes_{*scene_};
  std::uint64_t identity_;                                      // of the scene as it was read
  std::vector<scene::MechanicalState*> states_, shown_states_;  // independent ones; those of the bodies
  std::vector<scene::OdeSolver*> solvers_;
  std::vector<scene::SceneBody> scene_bodies_;
  std::vector<output::Bodies::Entry> entries_;
  std::shared_ptr<std::atomic_flag> taken_ = std::make_shared<std::atomic_flag>();  // of the scene with its bodies
  std::vector<std::shared_ptr<SceneBody>> bodies_;
  PointArray positions_, velocities_;  // of several shown states
  ShownField shown_positions_, shown_velocities_;
  std::optional<long> planned_steps_;
  long num_steps_ = 0;
  double load_time_ = 0;  // [s] at which the latest step took its loads
  std::string title_;
  std::shared_ptr<MotionRecord> record_;  // null: not wanted
};

/// An instrument of a scene, led by its path: that of the scene file, or from where it is to where it is set.
class SceneInstrument final : public Instrument {
 public:
  SceneInstrument(Scene& scene, std::string path) : scene_(scene), path_(std::move(path)) {
    owner_ = &scene::named_attribute(scene.get(), path_ + ".positions", "instrument " + path_).owner();
    instrument_ = dynamic_cast<const scene::Instrument*>(owner_);
    if (!instrument_)
      throw InputError(
          fmt::format("instrument {}: {} '{}' is no instrument", path_, owner_->class_name(), owner_->name()));
  }

  std::atomic_flag& taken() override { return scene_.taken(); }
  const std::string& path() const { return path_; }
  py::object force() const override { return scene_.get(path_ + ".force"); }
  Pose pose() const override { return pose_at(scene_.time()); }
  Pose target() const override {
    const std::vector<double> times = numbers("keyTimes");
    return times.size() == 2 && times[0] == scene_.time() ? pose_at(times[1]) : pose();
  }
  bool touches() const override { return instrument_->contact_energy().has_value(); }

  void set_pose(const Pose& to) override {
    const Pose from = pose();
    const bool turns = owner_->find_data("orientations");
    if (!turns && !to.orientation.isApprox(from.orientation))
      throw InputError(fmt::format("{}: a {} has no orientation", path_, owner_->class_name()));
    const double now = scene_.time();
    scene_.set(path_ + ".keyTimes", py::make_tuple(now, now + scene_.dt()));
    scene_.set(path_ + ".positions", py::make_tuple(list(from.position), list(to.position)));
    if (turns)
      scene_.set(path_ + ".orientations",
                 py::make_tuple(list(from.orientation.coeffs()), list(to.orientation.coeffs())));
  }

 private:
  /// Of an attribute, as it is from the next step on; none where it is not there.
  std::vector<double> numbers(std::string_view name) const {
    scene::Data* data = owner_->find_data(name);
    const auto* values = data && data->is_given() ? std::get_if<std::vector<double>>(&data->value()) : nullptr;
    return values ? *values : std::vector<double>();
  }

  /// Paths of two key times, as set_pose writes them, are read from the attributes: what is set, or was loaded, reaches
  /// the component in the next step.
  Pose pose_at(double time) const {
    Pose pose = instrument_->pose(time);
    const std::vector<double> times = numbers("keyTimes");
    if (times.size() != 2 || (times[0] < time && time < times[1])) return pose;
    const bool is_behind = time >= times[1];
    const std::vector<double> positions = numbers("positions"), orientations = numbers("orientations");
    if (positions.size() == 6) pose.position = Vec3(&positions[is_behind ? 3 : 0]);
    if (orientations.size() == 8) pose.orientation = Eigen::Quaterniond(&orientations[is_behind ? 4 : 0]).normalized();
    return pose;
  }

  static py::list list(const Eigen::Ref<const Eigen::VectorXd>& numbers) {
    py::list all;
    for (const double number : numbers) all.append(number);
    return all;
  }

  Scene& scene_;
  std::string path_;
  scene::Object* owner_;
  const scene::Instrument* instrument_;
};

std::unique_ptr<Scene> make_scene(const path& file, const py::dict& overrides, const std::vector<std::string>& plugins,
                                  const std::vector<path>& plugin_path, const std::vector<path>& mesh_path) {
  return std::make_unique<Scene>(Source{file, assignments_from(overrides), plugins, plugin_path, mesh_path});
}

}  // namespace

void add_scene(py::module_& module) {
  py::class_<SceneBody, BodyState, std::shared_ptr<SceneBody>>(
      module, "SceneBody", "One of the bodies of a Scene. positions and velocities are read-only views that follow it.")
      .def_property_readonly("name", &SceneBody::name, "that of its node, or body_2 where that is no name or another's")
      .def_property_readonly("positions", in_turn([](SceneBody& b) { return b.shown_positions(); }), "(n, 3) [m]")
      .def_property_readonly("velocities", in_turn([](SceneBody& b) { return b.shown_velocities(); }), "(n, 3) [m/s]");

  py::class_<SceneInstrument, Instrument, std::shared_ptr<SceneInstrument>>(module, "SceneInstrument",
                                                                            "An instrument or grip of a Scene")
      .def_property_readonly("path", &SceneInstrument::path);

  py::class_<Scene> of_scene(
      module, "Scene",
      "A scene file in motion, step by step: the same bits as `hexaplast run` computes. positions and\n"
      "velocities are read-only views that follow it.");
  def_motion(of_scene)
      .def_property_readonly("positions", in_turn([](Scene& s) { return s.shown_positions(); }),
                             "(n, 3) [m]; of several bodies the nodes of one behind those of another")
      .def_property_readonly("velocities", in_turn([](Scene& s) { return s.shown_velocities(); }),
                             "(n, 3) [m/s], as positions")
      .def(py::init(&make_scene), py::arg("file"), py::arg("overrides") = py::dict(), py::kw_only(),
           py::arg("plugins") = std::vector<std::string>(), py::arg("plugin_path") = std::vector<path>(),
           py::arg("mesh_path") = std::vector<path>(),
           "overrides: {'bar/material.yieldStress': 500, ...}, as --set of the command takes them.\n"
           "mesh_path: directories to look for the scene's meshes and includes in")
      .def_property_readonly("bodies", &Scene::bodies, "list of SceneBody, in the order of the scene")
      .def_property_readonly(
          "body", &Scene::body,
          "The only SceneBody; None where the scene has only masses. ValueError where it has several")
      .def_property_readonly("planned_steps", &Scene::planned_steps, "those of RunSettings; None where it says none")
      .def("step", &Scene::step, "One time step")
      .def("run", &Scene::run, py::arg("steps") = py::none(),
           "Several steps; without a number, up to those that the scene's RunSettings say. Reports the worst of them")
      .def("open", in_turn([](Scene& s, SceneBody& body, py::handle joints) {
             s.open(body, indices("joints", joints, body.body().joints().count()));
           }),
           py::arg("body"), py::arg("joints"),
           "Opens joints of one of the bodies (numbers of body.joints, or a mask) between two steps: nodes that no "
           "closed\n"
           "joint holds together any more are split, and what acts on them acts on all copies, by their shares. "
           "ValueError,\n"
           "and nothing has changed, where a component of the scene cannot follow. Arrays taken before keep what they "
           "show")
      .def("reset", &Scene::reset, "Back to the beginning")
      .def(
          "set", in_turn([](Scene& s, const std::string& path, py::object value) { s.set(path, value); }),
          py::arg("path"), py::arg("value"),
          "Changes 'node/component.attribute' at the beginning of the next step, as an AttributeChange does: a "
          "number,\n"
          "text, or sequence of them; None: as if it were not given. reset takes it back. ValueError, and nothing has\n"
          "changed, where there is no such attribute, it cannot change in a run, or the value is none of it")
      .def("get", in_turn([](Scene& s, const std::string& path) { return s.get(path); }), py::arg("path"),
           "The present value of 'node/component.attribute': a number, text, or new array; None where it is neither\n"
           "given nor has a default. The reaction of a constraint is measured from the first time on that it, or a "
           "Probe, asks")
      .def_property_readonly("probes", in_turn([](Scene& s) { return s.probes(); }),
                             "Of each Probe its present value, by name")
      .def("force", in_turn([](Scene& s, const std::string& path) { return s.force(path); }), py::arg("path"),
           "(3,) [N] the output `force` of a component: of contact that of the body on the instrument, of a grip that "
           "of\n"
           "the tool on the body, in the latest step")
      .def(
          "instrument",
          [](Scene& s, std::string path) { return std::make_shared<SceneInstrument>(s, std::move(path)); },
          py::arg("path"), py::keep_alive<0, 1>(), "The instrument 'node/component', to be moved by its pose")
      .def("save", in_turn([](Scene& s) { return s.save(); }),
           "A checkpoint: time, bodies, contacts and solver memory. What comes after load() has the same bits. "
           "ValueError\n"
           "after a step that failed")
      .def("load", in_turn([](Scene& s, const py::bytes& data) { s.load(std::string_view(data)); }), py::arg("data"),
           "Takes over what save() of the same scene returned, or a checkpoint that `hexaplast run` wrote. What is "
           "damaged\n"
           "or another scene's is a ValueError, and changes nothing")
      .def(py::pickle(in_turn([](Scene& s) { return s.state(); }),
                      [](const py::tuple& state) {
                        auto made = std::make_unique<Scene>(Source::from(state[0]));
                        made->load(std::string_view(state[1].cast<py::bytes>()));
                        return made;
                      }))
      .def("state_hash", in_turn([](Scene& s) { return s.state_hash(); }),
           "16 hexadecimal digits, as `hexaplast run` prints them");

  module.def(
      "run",
      [](const path& file, std::optional<long> steps, const py::dict& overrides, bool record) {
        std::unique_ptr<Scene> scene = make_scene(file, overrides, {}, {}, {});
        if (record) scene->record();
        scene->run(steps);
        return scene;
      },
      py::arg("file"), py::arg("steps") = py::none(), py::arg("overrides") = py::dict(), py::kw_only(),
      py::arg("record") = false,
      "Runs a scene file and returns it as it then is; record: as Scene.record() from the beginning");
  module.def(
      "_page_of_run",
      [](const path& directory) {
        if (!std::filesystem::is_directory(directory))
          throw output::OutputError(fmt::format("{}: is no directory", directory.string()));
        const std::optional<output::ViewerData> data = output::read_viewer_data(directory);
        if (!data)
          throw InputError(fmt::format("{}: has no {}, which `hexaplast run --out` writes", directory.string(),
                                       output::kViewerName));
        if (!data->has_states)
          throw InputError(fmt::format("{}: the bodies have more than {} nodes, which the viewer does not show",
                                       directory.string(), output::ViewerStates::kMaxNodes));
        return output::viewer_page(directory.filename().string(), data->markup);
      },
      py::arg("directory"));
}

}  // namespace hexaplast::python
