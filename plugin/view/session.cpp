// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "attributes/contact.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/material/rows.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "picture/quantity.hpp"
#include "scene/region.hpp"
#include "scene/visuals.hpp"
#include "view/shown_scene.hpp"

namespace hexaplast::view {
namespace {

using attributes::Attribute;
using attributes::Type;

constexpr double kSliderReach = 100;  // a slider reaches from a hundredth of its first value to a hundred times it
constexpr double kHandDelay = 0.05;   // [s] within which the hand's dashpot lets tissue follow its spring
constexpr double kCutDepth = 0.1;     // of a cut, in sizes of the bodies
constexpr double kToolSize = 0.12;    // diameter of what touches, in sizes of the bodies

/// Several components may have one name: theirs begin with the path of the node, or else end with a number.
void make_names_unique(std::vector<Parameter>& parameters) {
  const auto count = [&](const std::string& name) { return std::ranges::count(parameters, name, &Parameter::name); };
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) {
    const std::string path = parameter.component->node().path();
    names.push_back(count(parameter.name) == 1 ? parameter.name
                                               : fmt::format("{}{}{}", path, path == "/" ? "" : "/", parameter.name));
  }
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto number = std::count(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(k), names[k]) + 1;
    parameters[k].name = number == 1 ? names[k] : fmt::format("{} {}", names[k], number);
  }
}

double size_of(const HexMesh& mesh) {
  return (mesh.positions().colwise().maxCoeff() - mesh.positions().colwise().minCoeff()).norm();
}

std::vector<scene::SceneBody> some_bodies(scene::Scene& scene) {
  std::vector<scene::SceneBody> bodies = scene::bodies_of(scene);
  if (bodies.empty())
    throw scene::SceneError(
        scene::format_error(scene.root().place(), "no body in the scene, and a window shows at least one"));
  return bodies;
}

/// The value of an attribute of one number, or of a list; 1 or 0 of a switch; none where it has none.
std::optional<double> first_value(scene::Data& data) {
  const scene::Value& value = data.value();
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* is_on = std::get_if<bool>(&value)) return *is_on ? 1 : 0;
  const auto* reals = std::get_if<std::vector<double>>(&value);
  return reals && !reals->empty() ? std::optional(reals->front()) : std::nullopt;
}

/// What the values of single hexahedra have been multiplied with; none where they are not given.
std::optional<double> factor_of(scene::Data& data, const std::vector<double>& of_hexahedra) {
  const auto* reals = std::get_if<std::vector<double>>(&data.value());
  if (!reals || reals->empty()) return std::nullopt;
  const auto greatest = std::ranges::max_element(of_hexahedra);
  return *greatest > 0 ? (*reals)[static_cast<std::size_t>(greatest - of_hexahedra.begin())] / *greatest : 1;
}

scene::Data& data_of(const Parameter& parameter) { return *parameter.component->find_data(parameter.attribute->name); }

std::optional<double> value_of(scene::Data& data, const Parameter& parameter) {
  return parameter.of_hexahedra.empty() ? first_value(data) : factor_of(data, parameter.of_hexahedra);
}

/// From where to where it makes sense to move a number: within its range, around what it is, and no rate faster than
/// is wise for the time step.
Parameter parameter_of(scene::Component& component, scene::Data& data, const Body& body, double dt) {
  const Attribute& attribute = data.attribute();
  const Material& material = body.materials().front();
  Parameter parameter{.attribute = &attribute,
                      .component = &component,
                      .name = std::string(attribute.name),
                      .value = first_value(data),
                      .may_be_none = attribute.initial.empty()};
  const auto* reals = std::get_if<std::vector<double>>(&data.value());
  const double fastest = kRecommendedFlowPerStep / dt;
  if (reals && reals->size() > 1) {
    const double greatest = std::ranges::max(*reals);
    const double bound = attribute.unit == "1/s" ? fastest : attribute.range.max;
    parameter.of_hexahedra = *reals;
    parameter.value = parameter.suggested = 1;
    parameter.min = 1 / kSliderReach;
    parameter.max = greatest > 0 ? std::clamp(bound / greatest, 1.0, kSliderReach) : kSliderReach;
    parameter.is_logarithmic = true;
    return parameter;
  }

  const bool is_stretch = attribute.range.min == 1;
  parameter.suggested = is_stretch ? 2 : material.young_modulus / 20;
  const double value = parameter.value.value_or(parameter.suggested);
  if (attribute.unit == "1/s") {
    parameter.min = 0;
    parameter.max = std::max(value, fastest);
  } else if (attribute.unit == "Pa" && value > 0) {
    parameter.min = value / kSliderReach;
    parameter.max = value * kSliderReach;
    parameter.is_logarithmic = true;
  } else {
    const double reach = std::max(std::abs(value), 1.0);
    parameter.min = std::max(attribute.range.min, -2 * reach);
    parameter.max = std::min(attribute.range.max, 5 * reach);
    if (attribute.range.exclusive_min) parameter.min += 1e-3;
    if (attribute.range.exclusive_max) parameter.max -= 1e-3;
  }
  return parameter;
}

}  // namespace

Session::Session(Subject subject, MakeComponent make)
    : subject_(std::move(subject)),
      bodies_(some_bodies(subject_.scene)),
      states_(scene::shown_states(subject_.scene)),
      shown_(entries_of(bodies_)),
      dt_(subject_.scene.dt()),
      hand_(subject_.scene, bodies_, std::move(make), size_of(shown_.mesh())),
      measurement_(shown_),
      present_mesh_(std::make_shared<const HexMesh>(shown_.mesh())),
      taken_mesh_(present_mesh_),
      mesh_(*taken_mesh_) {
  for (const scene::SceneBody& of : bodies_)
    for (const Row<Material>& row : material_rows())  // what a body may take anew between two steps
      if (scene::Data* data = of.field->find_data(row.name)) {
        Parameter& parameter = parameters_.emplace_back(parameter_of(*of.field, *data, *of.field->body(), dt_));
        if (!shown_.is_one()) parameter.name = of.name + "." + parameter.name;
      }
  for (scene::MaterialRegion* region : subject_.scene.root().all<scene::MaterialRegion>()) {
    const auto of =
        std::ranges::find(bodies_, region->node().nearest<scene::MechanicalState>(), &scene::SceneBody::state);
    const Body& body = *(of == bodies_.end() ? bodies_.front() : *of).field->body();
    for (const Row<Material>& row : material_rows())
      if (scene::Data* data = region->find_data(row.name); data->is_given()) {
        Parameter& parameter = parameters_.emplace_back(parameter_of(*region, *data, body, dt_));
        parameter.name = region->name() + "." + parameter.name;
      }
  }

  for (scene::Component* component : subject_.scene.root().all<scene::Component>())
    if (scene::Data* data = component->find_data(attributes::kActive.name);
        data && data->attribute().type == Type::kBool && data->attribute().access == attributes::Access::kInput)
      parameters_.push_back({.attribute = &data->attribute(),
                             .component = component,
                             .name = component->name() + "." + std::string(attributes::kActive.name),
                             .value = first_value(*data),
                             .max = 1});
  make_names_unique(parameters_);

  // a hand that is about as strong as a cube of the softest matter, and holds a handful of nodes
  const double size = std::cbrt(shown_.initial_volume());
  double young = bodies_.front().field->body()->materials().front().young_modulus;
  for (const scene::SceneBody& of : bodies_)
    young = std::min(young, of.field->body()->materials().front().young_modulus);
  suggested_hand_ = {.radius = 1.8 * std::cbrt(shown_.initial_volume() / mesh().num_elements()),
                     .stiffness = young * size,
                     .max_force = young * size * size / 2,
                     .damping = kHandDelay * young * size,
                     .size = kToolSize * size_of(mesh()),
                     .depth = kCutDepth * size_of(mesh())};
  hand_.before_grab = [this] { save(); };
  hand_.has_grown = [this] { saved_.clear(); };
  first_parameters_ = given_parameters();
  pacing_.set_step(dt_, Clock::now());
  subject_.scene.diagnostics().take_warnings();  // solvers repeat what they have said when the scene was read

  thread_ = std::thread([this] { work(); });
}

Session::~Session() { stop(); }

void Session::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void Session::post(std::function<void()> command) {
  {
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
  }
  wake_.notify_one();
}

void Session::run() {
  post([this] {
    is_running_ = failure_.empty();
    pacing_.begin(Clock::now());
  });
}

void Session::pause() {
  post([this] {
    is_running_ = false;
    steps_asked_ = 0;
  });
}

void Session::advance(long steps) {
  post([this, steps] {
    is_running_ = false;
    if (failure_.empty()) steps_asked_ += steps;
  });
}

void Session::reset() {
  post([this] {
    is_running_ = false;
    steps_asked_ = 0;
    attempt([this] {
      hand_.reset();
      const std::vector<scene::Data::Given> given = given_parameters();
      subject_.reset();
      latest_ = {};
      failure_.clear();
      step_ms_.clear();
      saved_.clear();
      const std::vector<Change> earlier = std::exchange(changes_, {});
      for (std::size_t k = 0; k < parameters_.size(); ++k) {
        const bool is_moved = std::ranges::any_of(earlier, [&](const Change& change) {
          return change.component == parameters_[k].component && change.attribute == parameters_[k].attribute->name;
        });
        if (!is_moved || given[k].value == first_parameters_[k].value) continue;
        data_of(parameters_[k]).put_back(given[k]);  // what the scene itself changes has gone back
        note_change(parameters_[k]);
      }
    });
  });
}

void Session::set_pace(Pace pace, double speed) {
  post([this, pace, speed] {
    pace_ = pace;
    pacing_.set_step(dt_ / speed, Clock::now());
  });
}

void Session::show(Quantity quantity) {
  post([this, quantity] { quantity_ = quantity; });
}

void Session::show_plastic_rest(bool shows) {
  post([this, shows] { shows_plastic_rest_ = shows; });
}

void Session::grab(const Touch& touch, const HandSettings& settings) {
  post([this, touch, settings] {
    if (failure_.empty()) attempt([&] { hand_.grab(touch, settings); });
  });
}

void Session::drag(const Vec3& place) {
  post([this, place] { hand_.drag(place); });
}

void Session::release() {
  post([this] { hand_.release(); });
}

void Session::undo() {
  post([this] {
    if (saved_.empty()) return;
    attempt([&] {
      restore(saved_.back());
      failure_.clear();
    });
    saved_.pop_back();
  });
}

void Session::set(std::string_view name, std::optional<double> value) {
  const auto parameter = std::ranges::find(parameters_, name, &Parameter::name);
  post([this, &parameter = *parameter, value] {
    std::optional<scene::Value> given;
    if (value && parameter.attribute->type == Type::kBool)
      given = *value != 0;
    else if (value && parameter.attribute->type != Type::kReals)
      given = *value;
    if (value && parameter.attribute->type == Type::kReals) {
      std::vector<double> values = parameter.of_hexahedra.empty() ? std::vector{1.0} : parameter.of_hexahedra;
      for (double& one : values) one *= *value;
      given = std::move(values);
    }
    if (change(*parameter.component, parameter.attribute->name, std::move(given), messages_)) note_change(parameter);
  });
}

bool Session::take(Snapshot& snapshot) {
  bool is_taken = false;
  {
    const std::lock_guard lock(mutex_);
    if (is_fresh_) {
      std::swap(snapshot, front_);
      is_fresh_ = false;
      is_taken = true;
    }
    is_wanted_ = true;
  }
  wake_.notify_one();
  if (is_taken && snapshot.mesh != taken_mesh_) {
    taken_mesh_ = snapshot.mesh;
    mesh_ = *taken_mesh_;  // in its place: pictures look at it
  }
  return is_taken;
}

void Session::work() {
  for (;;) {
    std::vector<std::function<void()>> commands;
    bool is_wanted = false, is_ending = false;
    {
      std::unique_lock lock(mutex_);
      const auto has_reason = [&] {
        return !commands_.empty() || is_ending_ || (is_wanted_ && has_changed_) || is_due();
      };
      if (is_running_ && pace_ == Pace::kRealTime)
        wake_.wait_until(lock, pacing_.due(), has_reason);
      else
        wake_.wait(lock, has_reason);
      commands.swap(commands_);
      is_wanted = is_wanted_;
      is_ending = is_ending_;
    }
    for (const auto& command : commands) command();
    has_changed_ = has_changed_ || !commands.empty();
    if (is_ending && steps_asked_ == 0) return;

    if (is_due()) step();
    // where time is short, it is for steps
    if (is_wanted && has_changed_ && (!is_late() || pacing_.is_show_due(Clock::now()))) publish();
  }
}

bool Session::is_due() const {
  return steps_asked_ > 0 || (is_running_ && (pace_ == Pace::kFree || pacing_.is_due(Clock::now())));
}

bool Session::is_late() const { return is_running_ && pace_ == Pace::kRealTime && pacing_.is_late(Clock::now()); }

/// Whatever goes wrong, the window lives on, and a reset leads out of it.
template <class Call>
void Session::attempt(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    failure_ = error.what();
    is_running_ = false;
    steps_asked_ = 0;
  }
}

void Session::step() {
  attempt([&] {
    hand_.begin_step();
    latest_ = subject_.step();
    step_ms_.push_back(static_cast<float>(latest_.step_ms));
    hand_.end_step();
  });
  for (const scene::Message& message : subject_.scene.diagnostics().take_warnings())
    if (!Hand::is_way_of_tool(message)) messages_.push_back(scene::format(message));
  steps_asked_ = std::max(steps_asked_ - 1, 0L);
  has_changed_ = true;
  pacing_.end_step(Clock::now());
}

std::vector<scene::Data::Given> Session::given_parameters() const {
  std::vector<scene::Data::Given> all;
  for (const Parameter& parameter : parameters_) all.push_back(data_of(parameter).given());
  return all;
}

void Session::save() {
  if (!subject_.serialize) return;
  Saved& saved = saved_.emplace_back();
  Archive archive([&saved](const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    saved.bytes.insert(saved.bytes.end(), bytes, bytes + size);
  });
  subject_.serialize(archive);
  saved.latest = latest_;
  saved.hand = hand_.save();
  saved.parameters = given_parameters();
  saved.changes = changes_;
  if (saved_.size() > kMaxUndo) saved_.pop_front();
}

void Session::restore(const Saved& saved) {
  hand_.restore(saved.hand);
  // components follow when they begin the next step
  for (std::size_t k = 0; k < parameters_.size(); ++k) data_of(parameters_[k]).put_back(saved.parameters[k]);
  Archive archive(saved.bytes);
  subject_.serialize(archive);
  latest_ = saved.latest;
  step_ms_.clear();
  changes_ = saved.changes;
}

/// Its present value, from the present time on.
void Session::note_change(const Parameter& parameter) {
  scene::Data& data = data_of(parameter);
  const double time = subject_.scene.time();
  std::erase_if(changes_, [&](const Change& earlier) {
    return earlier.time == time && earlier.component == parameter.component &&
           earlier.attribute == parameter.attribute->name;
  });
  changes_.push_back({.time = time,
                      .component = parameter.component,
                      .attribute = std::string(parameter.attribute->name),
                      .value = data.is_given() ? std::optional(scene::write_value(data.value())) : std::nullopt});
}

/// Puts them into the snapshot.
void Session::publish_values(const ElementFields& fields) {
  back_.quantity = quantity_;
  if (quantity_ == Quantity::kSpeed) {
    back_.of_hexahedra.clear();
    back_.values = output::speeds(scene::velocities_of(states_, velocities_));
    return;
  }
  if (quantity_ == Quantity::kRegion)  // which the window knows
    back_.of_hexahedra.assign(static_cast<std::size_t>(shown_.mesh().num_elements()), 0);
  else
    back_.of_hexahedra = output::values_in(fields, quantity_);
  back_.values = nodal_means(shown_.mesh(), back_.of_hexahedra, shown_.alive());
}

/// Without the hand's instruments that are out of the way.
output::BoundaryConditions Session::conditions() const {
  if (!subject_.conditions) return {};
  output::BoundaryConditions conditions = subject_.conditions();
  const std::vector<scene::Instrument*> all = subject_.scene.root().all<scene::Instrument>();
  std::erase_if(conditions.instruments, [&](const output::Instrument& shown) {
    const auto* component = dynamic_cast<const scene::Component*>(all[static_cast<std::size_t>(shown.id)]);
    return component && hand_.is_idle(*component);
  });
  return conditions;
}

/// That of isolated rest shapes takes as long as some steps.
bool Session::wants_plastic_rest() const {
  return shows_plastic_rest_ || !back_.is_running || shown_.has_plastic_rest_at_hand();
}

void Session::publish() {
  const PointArray& x = scene::positions_of(states_, positions_);
  const ElementFields fields = shown_.fields(x);
  back_.step = latest_.step;
  back_.is_running = is_running_ || steps_asked_ > 0;
  back_.is_late = is_late();
  back_.failure = failure_;
  for (const std::string& message : hand_.take_messages()) messages_.push_back(message);
  back_.messages = std::exchange(messages_, {});
  if (present_mesh_->hexahedra() != shown_.mesh().hexahedra())
    present_mesh_ = std::make_shared<const HexMesh>(shown_.mesh());
  open_ = shown_.open_faces();
  back_.mesh = present_mesh_;
  back_.open = open_;
  back_.positions = x;
  const bool wants_rest = wants_plastic_rest();
  back_.plastic_rest = wants_rest ? shown_.plastic_rest_positions() : shown_.mesh().positions();
  const std::span<const unsigned char> alive = shown_.alive();
  back_.alive.assign(alive.begin(), alive.end());
  publish_values(fields);
  back_.parameter_values.clear();
  for (const Parameter& parameter : parameters_)
    back_.parameter_values.push_back(value_of(data_of(parameter), parameter));
  back_.held = hand_.held();
  for (int& node : back_.held) node += shown_.all()[static_cast<std::size_t>(hand_.held_body())].first_node;
  back_.hand_force = hand_.force();
  back_.conditions = conditions();
  back_.num_undo = static_cast<int>(saved_.size());
  back_.sample = {.time = subject_.scene.time(),
                  .measures = wants_rest ? measurement_.measure(x) : measurement_.measure_current(x),
                  .greatest_plastic_strain = std::ranges::max(fields.plastic_strain),
                  .kinetic_energy = latest_.kinetic_energy,
                  .elastic_energy = shown_.energy(x),
                  .dissipated_energy = shown_.dissipated_energy(),
                  .probes = latest_.probes};
  back_.step_ms = std::exchange(step_ms_, {});
  has_changed_ = false;
  pacing_.show(Clock::now());

  const std::lock_guard lock(mutex_);
  if (is_fresh_) {  // it was not taken: what it alone tells goes on
    front_.messages.insert(front_.messages.end(), back_.messages.begin(), back_.messages.end());
    back_.messages = std::move(front_.messages);
    front_.step_ms.insert(front_.step_ms.end(), back_.step_ms.begin(), back_.step_ms.end());
    back_.step_ms = std::move(front_.step_ms);
  }
  std::swap(front_, back_);
  is_fresh_ = true;
  is_wanted_ = false;
}

}  // namespace hexaplast::view
