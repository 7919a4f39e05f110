// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view/hand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/pick.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "hexaplast/mesh/faces.hpp"
#include "parts/contact_options.hpp"
#include "scene/scene.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::view {
namespace {

constexpr double kNever = 1e300;      // [s] a time that no session reaches
constexpr double kGripReach = 10;     // sizes of the scene: a grip holds the nodes that it is told, wherever they are
constexpr double kAway = 3;           // sizes of the scene from it, an instrument touches nothing
constexpr double kGap = 0.02;         // sizes of an instrument between it and the tissue, when it comes
constexpr double kCapsuleLength = 2;  // diameters, without the caps
constexpr double kArrived = 1e-6;     // sizes of the scene
constexpr const char* kGripClass = "GraspForceField";
constexpr const char* kToolClass = "InstrumentContactForceField";
constexpr const char* kScalpelClass = "BladeController";

const scene::Place kWindow{.file = "window"};

/// Nodes of the surface of what is left of a body, ascending.
std::vector<int> surface_nodes(const Body& body) {
  std::vector<int> nodes;
  for (const Quad& face : body.mesh().boundary_faces(body.alive())) nodes.insert(nodes.end(), face.begin(), face.end());
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void set(scene::Component& component, std::string_view attribute, scene::Value value) {
  component.find_data(attribute)->set(std::move(value), kWindow);
}

std::vector<double> numbers_of(std::initializer_list<Vec3> places) {
  std::vector<double> numbers;
  for (const Vec3& place : places) numbers.insert(numbers.end(), place.begin(), place.end());
  return numbers;
}

/// What InstrumentContactForceField needs of a body's surroundings.
std::string why_untouchable(scene::Scene& scene, const scene::SceneBody& body) {
  auto* integrator = body.state->node().nearest<scene::OdeSolver>();
  const std::string lacks = parts::integrator_lacks(
      integrator ? integrator->class_name() : "", [&](const char* scheme) { return integrator->boolean(scheme); },
      "in its node or above");
  if (!lacks.empty()) return fmt::format("{}: {}", body.name, lacks);
  for (const scene::Mapping* mapping : scene.root().all<scene::Mapping>())
    if (mapping->output() == body.state) return fmt::format("{} follows another state", body.name);
  return {};
}

/// The only surface that is embedded in a body; null: there is none, or there are several.
scene::VisualModel* embedded_surface(scene::Scene& scene, const scene::SceneBody& body) {
  scene::VisualModel* found = nullptr;
  for (scene::VisualModel* model : scene.root().all<scene::VisualModel>()) {
    if (!model->is_carried() || model->points().rows() == 0) continue;
    const scene::Node* node = &model->node();
    while (node && !(node == &body.field->node())) node = node->parent();
    if (!node) continue;
    if (found) return nullptr;
    found = model;
  }
  return found;
}

/// The surface that is seen is the one that is touched.
void link_embedded_surface(scene::Component& tool, scene::VisualModel& model) {
  scene::Data *points = model.find_data("position"), *triangles = model.find_data("triangles");
  const auto* given = std::get_if<std::vector<double>>(&points->value());
  const bool has_own = given && static_cast<Eigen::Index>(given->size()) == model.points().size();
  if (has_own && model.quads().empty()) {
    const std::string path = model.node().path();
    const std::string link = fmt::format("@{}{}{}.", path, path == "/" ? "" : "/", model.name());
    tool.find_data("embeddedPositions")->follow(*points, link + "position");
    tool.find_data("embeddedTriangles")->follow(*triangles, link + "triangles");
    return;
  }
  std::vector<std::int64_t> corners;
  for (const Triangle& face : model.triangles()) corners.insert(corners.end(), face.begin(), face.end());
  for (const auto& [a, b, c, d] : model.quads()) corners.insert(corners.end(), {a, b, c, a, c, d});
  set(tool, "embeddedPositions",
      std::vector<double>(model.points().data(), model.points().data() + model.points().size()));
  set(tool, "embeddedTriangles", std::move(corners));
}

/// Everything but the path.
void shape(scene::Component& tool, const HandSettings& settings) {
  set(tool, "shape", std::string(kToolNames[static_cast<std::size_t>(settings.tool)]));
  set(tool, "radius", settings.size / 2);
  set(tool, "length", kCapsuleLength * settings.size);
  set(tool, "size", std::vector<double>(3, settings.size));
  set(tool, "friction", settings.friction);
}

/// The edge of a scalpel: along z, towards the viewer, as long as the body, and so deep in it.
void shape_edge(scene::Component& scalpel, double length, double depth) {
  set(scalpel, "points", numbers_of({{0, 0, length}, {0, 0, -depth}}));
}

double size_of(const Body& body) {
  const PointArray& X = body.initial_mesh().positions();
  return (X.colwise().maxCoeff() - X.colwise().minCoeff()).norm();
}

}  // namespace

bool change(scene::Component& component, std::string_view attribute, std::optional<scene::Value> value,
            std::vector<std::string>& messages) {
  scene::Data& data = *component.find_data(attribute);
  const scene::Data::Given before = data.given();
  try {
    if (value)
      data.set(std::move(*value), kWindow);
    else
      data.unset();
  } catch (const InputError& error) {
    messages.push_back(fmt::format("{}: {}", attribute, error.what()));
    return false;
  }
  try {
    component.follow_inputs();
    return true;
  } catch (const std::exception& error) {
    messages.emplace_back(error.what());
    data.put_back(before);
    component.follow_inputs();
    return false;
  }
}

Hand::Hand(scene::Scene& scene, std::vector<scene::SceneBody> bodies, MakeComponent make, double reach)
    : scene_(scene), bodies_(std::move(bodies)), make_(std::move(make)), reach_(reach) {
  for (const scene::SceneBody& body : bodies_) {
    std::unique_ptr<scene::Component> grip = make_(kGripClass);
    set(*grip, "graspTime", kNever);
    set(*grip, "keyTimes", std::vector<double>{0});
    set(*grip, "positions", std::vector<double>{0, 0, 0});
    set(*grip, "radius", kGripReach * reach_);
    grips_.push_back(grip.get());
    scene_.add(body.state->node(), std::move(grip), "hand");
    scalpels_.push_back(nullptr);
    if (touch_refusal_.empty()) touch_refusal_ = why_untouchable(scene_, body);
  }
}

void Hand::add_tools(const HandSettings& settings) {
  if (!tools_.empty()) return;
  for (const scene::SceneBody& body : bodies_) {
    std::unique_ptr<scene::Component> tool = make_(kToolClass);
    set(*tool, "keyTimes", std::vector<double>{0});
    set(*tool, "positions", numbers_of({away_}));
    shape(*tool, settings);
    set(*tool, "orientations", std::vector<double>(turn_.begin(), turn_.end()));
    if (scene::VisualModel* surface = embedded_surface(scene_, body)) link_embedded_surface(*tool, *surface);
    tools_.push_back(tool.get());
    try {
      scene_.add(body.state->node(), std::move(tool), "tool");
    } catch (const std::exception& error) {
      damage_ = error.what();
      throw;
    }
  }
  has_grown();
}

void Hand::add_scalpel(std::size_t body, const HandSettings& settings) {
  if (scalpels_[body]) return;
  std::unique_ptr<scene::Component> scalpel = make_(kScalpelClass);
  set(*scalpel, "keyTimes", std::vector<double>{0});
  set(*scalpel, "positions", numbers_of({away_}));
  set(*scalpel, "orientations", std::vector<double>(turn_.begin(), turn_.end()));
  shape_edge(*scalpel, size_of(*bodies_[body].field->body()), settings.depth);
  scalpels_[body] = scalpel.get();
  try {
    scene_.add(bodies_[body].state->node(), std::move(scalpel), "scalpel");
  } catch (const std::exception& error) {
    damage_ = error.what();
    throw;
  }
  has_grown();
}

std::vector<scene::Component*> Hand::tools_and_scalpels() const {
  std::vector<scene::Component*> all = tools_;
  std::ranges::copy_if(scalpels_, std::back_inserter(all), [](const scene::Component* scalpel) { return scalpel; });
  return all;
}

void Hand::grab(const Touch& touch, const HandSettings& settings) {
  release();
  if (state_ == State::kLeaving)
    request_ = {touch, settings, {}};
  else
    begin_grab(touch, settings);
}

void Hand::begin_grab(const Touch& touch, const HandSettings& settings) {
  if (settings.tool == Tool::kGrip) return close_grip(touch.place, settings);
  if (settings.tool == Tool::kScalpel) return bring_scalpel(touch, settings);
  if (!touch_refusal_.empty()) return messages_.push_back("nothing can be touched: " + touch_refusal_);
  bring_tool(touch, settings);
}

bool Hand::is_way_of_tool(const scene::Message& message) {
  return message.place.file == kWindow.file && message.text.starts_with(fmt::format("{}.positions: ", kToolClass));
}

std::size_t Hand::nearest_body(const Vec3& place) const {
  std::size_t nearest = 0;
  double min = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const PointArray& x = bodies_[k].state->positions();
    for (const int node : nearest_nodes(x, surface_nodes(*bodies_[k].field->body()), place, 0, 1))
      if (const double distance = (x.row(node).transpose() - place).norm(); distance < min) {
        min = distance;
        nearest = k;
      }
  }
  return nearest;
}

void Hand::close_grip(const Vec3& place, const HandSettings& settings) {
  const std::size_t nearest = nearest_body(place);
  const std::vector<int> held = nearest_nodes(
      bodies_[nearest].state->positions(), surface_nodes(*bodies_[nearest].field->body()), place, settings.radius, 1);
  if (held.empty()) return;  // nothing is left of the bodies
  before_grab();

  scene::Component& grip = *grips_[nearest];
  held_body_ = static_cast<int>(nearest);
  active_ = {&grip};
  tool_ = Tool::kGrip;
  is_coming_ = false;
  offset_.setZero();
  at_ = target_ = place;
  const double time = scene_.time();
  std::vector<std::int64_t> initial;  // a grip takes all copies of a node
  for (const int node : held)
    if (const int first = bodies_[nearest].field->body()->copies().initial()[node];
        std::ranges::find(initial, first) == initial.end())
      initial.push_back(first);
  change(grip, "indices", std::move(initial), messages_);
  change(grip, "stiffness", settings.stiffness, messages_);
  change(grip, "maxForce", settings.max_force, messages_);
  change(grip, "damping", settings.damping, messages_);
  put_path({time}, {place});
  change(grip, "graspTime", time, messages_);
  grip.begin_step();  // it closes here, and not where the mouse will be when the next step begins
  state_ = State::kHolding;
  begin_motions();
}

void Hand::bring_tool(const Touch& touch, const HandSettings& settings) {
  const double half = settings.size / 2;
  const bool is_capsule = settings.tool == Tool::kCapsule;
  const double height = is_capsule ? half + kCapsuleLength * half : half;  // from the middle to the end that touches
  const Vec3 start = touch.place + (height + kGap * settings.size) * touch.outwards;
  const Vec3 away = start + (kAway * reach_ + settings.size) * touch.towards;
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), touch.outwards);
  turn_ = {turn.x(), turn.y(), turn.z(), turn.w()};
  away_ = away;
  add_tools(settings);
  before_grab();

  active_ = tools_;
  for (scene::Component* tool : tools_) shape(*tool, settings);
  offset_ = start - touch.place;
  bring(settings.tool, start, away);
}

void Hand::bring_scalpel(const Touch& touch, const HandSettings& settings) {
  const std::size_t nearest = nearest_body(touch.place);
  scene::ForceField& field = *bodies_[nearest].field;
  try {
    if (!scalpels_[nearest]) scene::require_followers(field);
  } catch (const scene::SceneError& error) {
    return messages_.push_back(fmt::format("nothing can be cut: {}", error.what()));
  }
  const double size = size_of(*field.body());
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), touch.towards);
  turn_ = {turn.x(), turn.y(), turn.z(), turn.w()};
  out_ = kAway * size * touch.towards;
  const Vec3 away = touch.place + out_;
  away_ = away;
  add_scalpel(nearest, settings);
  before_grab();

  active_ = {scalpels_[nearest]};
  shape_edge(*active_.front(), size, settings.depth);
  offset_.setZero();
  bring(settings.tool, touch.place, away);
}

/// What is active begins away, and is at its start after the next step.
void Hand::bring(Tool tool, const Vec3& start, const Vec3& away) {
  tool_ = tool;
  is_coming_ = true;
  at_ = away;
  target_ = start;
  put_path({scene_.time()}, {at_});
  for (scene::Component* component : active_) component->follow_inputs();
  state_ = State::kHolding;
  begin_motions();
}

void Hand::drag(const Vec3& place) {
  if (request_) request_->place = place;
  if (state_ == State::kHolding && !request_) target_ = place + offset_;
}

void Hand::release() {
  request_.reset();
  if (state_ != State::kHolding) return;
  if (tool_ != Tool::kGrip) {
    if (tool_ == Tool::kScalpel) away_ = at_ + out_;  // along its edge, which opens nothing
    target_ = away_;
    is_coming_ = true;
    state_ = State::kLeaving;
    drop_motions_without_step();
    if (num_open_motions_ == 0) state_ = State::kIdle;  // it has not come yet
    return;
  }
  scene::Component& grip = *active_.front();
  change(grip, "graspTime", kNever, messages_);
  dynamic_cast<scene::Stateful&>(grip).reset();
  drop_motions_without_step();
  if (num_open_motions_ > 0) motions_.back().attributes.emplace_back("releaseTime", fmt::format("{}", scene_.time()));
  num_open_motions_ = 0;
  state_ = State::kIdle;
}

void Hand::begin_step() {
  if (state_ == State::kIdle) return;
  const double time = scene_.time(), next = time + scene_.dt();
  const Vec3 way = target_ - at_;
  const bool arrives = is_coming_ || way.norm() < kArrived * reach_;
  const Vec3 to = arrives ? target_ : Vec3(at_ + (1 - std::exp(-scene_.dt() / kFollow)) * way);
  put_path({time, next}, {at_, to});
  add_key(next, to);
  at_ = to;
}

void Hand::end_step() {
  is_coming_ = false;
  if (state_ != State::kLeaving) return;
  state_ = State::kIdle;
  num_open_motions_ = 0;
  if (const std::optional<Request> request = std::exchange(request_, {})) {
    begin_grab(request->touch, request->settings);
    if (request->place) drag(*request->place);
  }
}

void Hand::require_whole() const {
  if (!damage_.empty())
    throw scene::SceneError("the scene has refused an instrument and must be opened anew: " + damage_);
}

void Hand::reset() {
  require_whole();
  request_.reset();
  if (state_ == State::kHolding) release();
  state_ = State::kIdle;
  motions_.clear();
  num_open_motions_ = 0;
  at_ = away_;
  const std::vector<scene::Component*> in_use = std::exchange(active_, {});
  for (scene::Component* component : tools_and_scalpels()) {
    const auto& way = std::get<std::vector<double>>(component->find_data("positions")->value());
    const bool was_in_use = std::ranges::find(in_use, component) != in_use.end();
    active_ = {component};
    put_path({0.0}, {was_in_use ? away_ : Vec3(way.end()[-3], way.end()[-2], way.end()[-1])});
  }
}

std::vector<int> Hand::held() const {
  if (state_ != State::kHolding || tool_ != Tool::kGrip) return {};
  const std::vector<std::int64_t>& held = active_.front()->integers("grasped");
  return {held.begin(), held.end()};
}

Vec3 Hand::force() const {
  Vec3 force = Vec3::Zero();
  if (state_ != State::kHolding || tool_ == Tool::kScalpel) return force;
  for (scene::Component* component : active_) force += (tool_ == Tool::kGrip ? 1 : -1) * component->vector3("force");
  return force;
}

bool Hand::is_idle(const scene::Component& component) const {
  const std::vector<scene::Component*> all = tools_and_scalpels();
  const bool is_in_use = state_ == State::kHolding && std::ranges::find(active_, &component) != active_.end();
  return std::ranges::find(all, &component) != all.end() && !is_in_use;
}

void Hand::put_path(std::initializer_list<double> times, std::initializer_list<Vec3> places) {
  for (scene::Component* component : active_) {
    set(*component, "keyTimes", std::vector<double>(times));
    set(*component, "positions", numbers_of(places));
    if (!component->find_data("orientations")) continue;
    std::vector<double> turns;
    for (std::size_t k = 0; k < times.size(); ++k) turns.insert(turns.end(), turn_.begin(), turn_.end());
    set(*component, "orientations", std::move(turns));
  }
}

void Hand::begin_motions() {
  num_open_motions_ = active_.size();
  for (scene::Component* component : active_) {
    InstrumentMotion& motion = motions_.emplace_back();
    motion.node = &component->node();
    motion.class_name = component->class_name();
    for (const auto& data : component->all_data()) {
      const std::string_view name = data->attribute().name;
      const bool is_of_path = name == "keyTimes" || name == "positions" || name == "orientations";
      if (is_of_path || name == "name" || !data->is_given() || data->attribute().access != attributes::Access::kInput)
        continue;
      motion.attributes.emplace_back(name, data->link().empty() ? scene::write_value(data->value()) : data->link());
    }
  }
  add_key(scene_.time(), at_);
}

void Hand::add_key(double time, const Vec3& place) {
  for (auto motion = motions_.end() - static_cast<std::ptrdiff_t>(num_open_motions_); motion != motions_.end();
       ++motion) {
    motion->key_times.push_back(time);
    motion->positions.insert(motion->positions.end(), place.begin(), place.end());
    if (tool_ != Tool::kGrip) motion->orientations.insert(motion->orientations.end(), turn_.begin(), turn_.end());
  }
}

void Hand::drop_motions_without_step() {
  while (num_open_motions_ > 0 && motions_.back().key_times.size() < 2) {
    motions_.pop_back();
    --num_open_motions_;
  }
}

Hand::Saved Hand::save() const {
  Saved saved{.values = {}, .num_motions = motions_.size() - num_open_motions_};
  for (scene::Component* tool : tools_and_scalpels())
    for (const auto& data : tool->all_data())
      if (data->is_given() && data->link().empty()) saved.values.push_back(data->value());
  return saved;
}

void Hand::restore(const Saved& saved) {
  require_whole();
  release();
  state_ = State::kIdle;
  request_.reset();
  motions_.resize(saved.num_motions);
  num_open_motions_ = 0;
  auto value = saved.values.begin();
  for (scene::Component* tool : tools_and_scalpels()) {
    for (const auto& data : tool->all_data())
      if (data->is_given() && data->link().empty()) data->set(*value++, kWindow);
    tool->follow_inputs();
  }
}

}  // namespace hexaplast::view
