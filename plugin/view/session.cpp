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
#include "hexaplast/geometry/pick.hpp"
#include "hexaplast/material/rows.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "scene/region.hpp"

namespace hexaplast::view {
namespace {

using attributes::Attribute;
using attributes::Type;

constexpr double kNever = 1e300;       // [s] a time that no session reaches
constexpr double kEverywhere = 1e300;  // [m]
constexpr double kSliderReach = 100;   // a slider reaches from a hundredth of its first value to a hundred times it
constexpr double kHandDelay = 0.05;    // [s] within which the hand's dashpot lets tissue follow its spring
constexpr auto kPatience = std::chrono::milliseconds(100);  // by which real time may run ahead before it is given up

const scene::Place kWindow{.file = "window"};

std::vector<scene::SceneBody> some_bodies(scene::Scene& scene) {
  std::vector<scene::SceneBody> bodies = scene::bodies_of(scene);
  if (bodies.empty())
    throw scene::SceneError(
        scene::format_error(scene.root().place(), "no body in the scene, and a window shows at least one"));
  return bodies;
}

std::vector<output::Bodies::Entry> entries_of(const std::vector<scene::SceneBody>& bodies) {
  std::vector<output::Bodies::Entry> entries;
  for (const scene::SceneBody& body : bodies) entries.push_back({.name = body.name, .body = body.field->body()});
  return entries;
}

/// Nodes of the surface of what is left of a body, ascending.
std::vector<int> surface_nodes(const Body& body) {
  std::vector<int> nodes;
  for (const Quad& face : body.mesh().boundary_faces(body.alive())) nodes.insert(nodes.end(), face.begin(), face.end());
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
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

Session::Session(Subject subject, const MakeHand& make_hand)
    : subject_(std::move(subject)),
      bodies_(some_bodies(subject_.scene)),
      shown_(entries_of(bodies_)),
      dt_(subject_.scene.dt()),
      measurement_(shown_) {
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

  // a hand that is about as strong as a cube of the softest matter, and holds a handful of nodes
  const double size = std::cbrt(shown_.initial_volume());
  double young = bodies_.front().field->body()->materials().front().young_modulus;
  for (const scene::SceneBody& of : bodies_)
    young = std::min(young, of.field->body()->materials().front().young_modulus);
  suggested_hand_ = {.radius = 1.8 * std::cbrt(shown_.initial_volume() / mesh().num_elements()),
                     .stiffness = young * size,
                     .max_force = young * size * size / 2,
                     .damping = kHandDelay * young * size};

  for (const scene::SceneBody& of : bodies_) {
    std::unique_ptr<scene::Component> hand = make_hand();
    const auto give = [&](std::string_view attribute, scene::Value value) {
      hand->find_data(attribute)->give(std::move(value), kWindow);
    };
    give("graspTime", kNever);
    give("keyTimes", std::vector<double>{0});
    give("positions", std::vector<double>{0, 0, 0});
    give("radius", kEverywhere);
    hands_.push_back(hand.get());
    subject_.scene.add(of.state->node(), std::move(hand), "hand");
  }
  hand_ = hands_.front();
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
    due_ = Clock::now();
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
    open_hand();
    subject_.reset();
    is_running_ = false;
    steps_asked_ = 0;
    latest_ = {};
    failure_.clear();
    step_ms_.clear();
  });
}

void Session::set_pace(Pace pace) {
  post([this, pace] {
    pace_ = pace;
    due_ = Clock::now();
  });
}

void Session::show(Quantity quantity) {
  post([this, quantity] { quantity_ = quantity; });
}

void Session::grab(const Vec3& place, const HandSettings& settings) {
  post([this, place, settings] {
    open_hand();
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const PointArray& x = bodies_[k].state->positions();
      for (const int node : nearest_nodes(x, surface_nodes(*bodies_[k].field->body()), place, 0, 1))
        if (const double distance = (x.row(node).transpose() - place).norm(); distance < least) {
          least = distance;
          nearest = k;
        }
    }
    const std::vector<int> held = nearest_nodes(
        bodies_[nearest].state->positions(), surface_nodes(*bodies_[nearest].field->body()), place, settings.radius, 1);
    if (held.empty()) return;  // nothing is left of the bodies
    hand_ = hands_[nearest];
    first_held_ = shown_.all()[nearest].first_node;

    change(*hand_, "indices", std::vector<std::int64_t>(held.begin(), held.end()));
    change(*hand_, "positions", std::vector<double>(place.begin(), place.end()));
    change(*hand_, "stiffness", settings.stiffness);
    change(*hand_, "maxForce", settings.max_force);
    change(*hand_, "damping", settings.damping);
    change(*hand_, "graspTime", subject_.scene.time());
    hand_->begin_step();  // it closes here, and not where the mouse will be when the next step begins
  });
}

void Session::drag(const Vec3& place) {
  post([this, place] { change(*hand_, "positions", std::vector<double>(place.begin(), place.end())); });
}

void Session::release() {
  post([this] { open_hand(); });
}

void Session::set(std::string_view name, std::optional<double> value) {
  const auto parameter = std::ranges::find(parameters_, name, &Parameter::name);
  post([this, &parameter = *parameter, value] {
    const std::string_view attribute = parameter.attribute->name;
    if (!value) return change(*parameter.component, attribute, std::nullopt);
    if (parameter.attribute->type == Type::kBool)
      return change(*parameter.component, attribute, scene::Value(*value != 0));
    if (parameter.attribute->type != Type::kReals) return change(*parameter.component, attribute, scene::Value(*value));
    std::vector<double> values = parameter.of_hexahedra.empty() ? std::vector{1.0} : parameter.of_hexahedra;
    for (double& one : values) one *= *value;
    change(*parameter.component, attribute, scene::Value(std::move(values)));
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
        wake_.wait_until(lock, due_, has_reason);
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
    if (is_wanted && has_changed_) publish();
  }
}

bool Session::is_due() const {
  return steps_asked_ > 0 || (is_running_ && (pace_ == Pace::kFree || Clock::now() >= due_));
}

void Session::step() {
  try {
    latest_ = subject_.step();
    step_ms_.push_back(static_cast<float>(latest_.step_ms));
  } catch (const std::exception& error) {  // whatever it is, the window lives on, and a reset leads out of it
    failure_ = error.what();
    is_running_ = false;
    steps_asked_ = 0;
  }
  for (const scene::Message& message : subject_.scene.diagnostics().take_warnings())
    messages_.push_back(scene::format(message));
  steps_asked_ = std::max(steps_asked_ - 1, 0L);
  has_changed_ = true;

  due_ += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(dt_));
  if (const Clock::time_point now = Clock::now(); due_ + kPatience < now) due_ = now;
}

// The component looks at its inputs at once, so that what it refuses can be taken back.
void Session::change(scene::Component& component, std::string_view attribute, std::optional<scene::Value> value) {
  scene::Data& data = *component.find_data(attribute);
  const auto put = [&](std::optional<scene::Value> one) {
    if (one)
      data.give(std::move(*one), kWindow);
    else
      data.unset();
  };
  const auto before = data.is_given() ? std::optional(data.value()) : std::nullopt;
  try {
    put(std::move(value));
  } catch (const InputError& error) {
    messages_.push_back(fmt::format("{}: {}", attribute, error.what()));
    return;
  }
  try {
    component.follow_inputs();
  } catch (const std::exception& error) {
    messages_.push_back(error.what());
    put(before);
    component.follow_inputs();
  }
}

void Session::open_hand() {
  change(*hand_, "graspTime", kNever);
  hand_->reset();
}

/// A field of all bodies.
const PointArray& Session::gather(PointArray& (scene::MechanicalState::*field)(), PointArray& all) const {
  if (shown_.is_one()) return (bodies_.front().state->*field)();
  all.resize(mesh().num_nodes(), 3);
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    output::Bodies::rows(shown_.all()[k], all) = (bodies_[k].state->*field)();
  return all;
}

std::vector<double> Session::values_of(Quantity quantity, const ElementFields& fields) {
  const auto nodal = [&](const std::vector<double>& of_hexahedra) {
    return nodal_means(mesh(), of_hexahedra, shown_.alive());
  };
  switch (quantity) {
    case Quantity::kPlasticStrain:
      return nodal(fields.plastic_strain);
    case Quantity::kStressNorm:
      return nodal(fields.stress_norm);
    case Quantity::kYieldStress:
      return nodal(fields.yield_stress);
    case Quantity::kVolumeRatio:
      return nodal(fields.volume_ratio);
    case Quantity::kSpeed:
      break;
  }
  std::vector<double> speed(static_cast<std::size_t>(mesh().num_nodes()));
  Eigen::VectorXd::Map(speed.data(), mesh().num_nodes()) =
      gather(&scene::MechanicalState::velocities, velocities_).rowwise().norm();
  return speed;
}

void Session::publish() {
  const PointArray& x = gather(&scene::MechanicalState::positions, positions_);
  const ElementFields fields = shown_.fields(x);
  back_.step = latest_.step;
  back_.is_running = is_running_ || steps_asked_ > 0;
  back_.failure = failure_;
  back_.messages = std::exchange(messages_, {});
  back_.positions = x;
  back_.material = shown_.plastic_rest_positions();
  const std::span<const unsigned char> alive = shown_.alive();
  back_.alive.assign(alive.begin(), alive.end());
  back_.quantity = quantity_;
  back_.values = values_of(quantity_, fields);
  back_.parameter_values.clear();
  for (const Parameter& parameter : parameters_)
    back_.parameter_values.push_back(value_of(*parameter.component->find_data(parameter.attribute->name), parameter));
  const std::vector<std::int64_t>& held = hand_->integers("grasped");
  back_.held.assign(held.begin(), held.end());
  for (int& node : back_.held) node += first_held_;
  back_.grip_force = hand_->vector3("force");
  back_.sample = {.time = subject_.scene.time(),
                  .measures = measurement_.measure(x),
                  .greatest_plastic_strain = std::ranges::max(fields.plastic_strain),
                  .kinetic_energy = latest_.kinetic_energy,
                  .elastic_energy = shown_.energy(x),
                  .dissipated_energy = shown_.dissipated_energy()};
  back_.step_ms = std::exchange(step_ms_, {});
  has_changed_ = false;

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
