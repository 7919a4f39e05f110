// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hexaplast/base/error.hpp"
#include "hexaplast/plastic/flow_report.hpp"
#include "scene/interfaces.hpp"
#include "scene/links.hpp"

namespace hexaplast::scene {
namespace {

constexpr double kTorn = 0.5;  // where tissue crosses the links that it tears

/// Contacts come last: they follow from bodies, which may stand behind them.
bool is_contact(const Component& component) {
  const auto* field = dynamic_cast<const ForceField*>(&component);
  const auto* interaction = dynamic_cast<const Interaction*>(&component);
  return (field && field->is_one_sided()) || (interaction && interaction->is_one_sided());
}

}  // namespace

Scene::Scene() : diagnostics_(std::make_unique<Diagnostics>()), root_(std::make_unique<Node>(nullptr)) {}

// Runs one call of a component's life; what it objects to joins the scene's errors, and the component counts as failed.
template <class Call>
void Scene::attempt(Component& component, const Call& call) {
  const auto fail = [&](const Message& message) {
    component.stage_ = Component::Stage::kFailed;
    diagnostics_->add(message);
  };
  try {
    call();
  } catch (const Rejection& rejection) {
    fail(rejection.message());
  } catch (const InputError& error) {
    fail({Severity::kError, component.place(), fmt::format("{}: {}", component.class_name(), error.what()), {}});
  } catch (const DependencyFailure&) {
    component.stage_ = Component::Stage::kFailed;
  }
}

void Scene::init() {
  resolve_links(*root_, *diagnostics_);
  diagnostics_->throw_errors();

  Clock& clock = root_->clock();
  clock = {.time = 0, .dt = root_->real("dt"), .gravity = root_->vector3("gravity")};
  root_->for_each<Component>([this](Component& component) { init(component); });
  bwd_init(*root_);
  diagnostics_->throw_errors();
}

void Scene::init(Component& component) {
  attempt(component, [&] {
    component.init();
    if (!component.looks_by_itself()) component.accept_inputs();
    component.stage_ = Component::Stage::kReady;
  });
}

void Scene::bwd_init(Node& node) {
  for (const auto& child : node.children()) bwd_init(*child);
  for (const auto& component : node.components()) bwd_init(*component);
}

void Scene::bwd_init(Component& component) {
  if (component.stage() == Component::Stage::kReady) attempt(component, [&] { component.bwd_init(); });
}

Component& Scene::add(Node& node, std::unique_ptr<Component> component, std::string name) {
  Component& added = node.add(std::move(component));
  added.introduce(std::move(name), node.place(), *diagnostics_);
  init(added);
  bwd_init(added);
  root_->for_each<OdeSolver>([this](OdeSolver& solver) { bwd_init(solver); });
  diagnostics_->throw_errors();
  return added;
}

void Scene::reset() {
  trouble_ = "a reset has failed";
  root_->clock().time = 0;
  // bodies first: the others meet the nodes that there were at first
  root_->for_each<ForceField>([](ForceField& field) {
    auto* stateful = dynamic_cast<Stateful*>(&field);
    if (field.body() && stateful) stateful->reset();
  });
  const auto reset_parts = [&] {
    root_->for_each<Stateful>([](Stateful& component) {
      if (!dynamic_cast<OdeSolver*>(&component)) component.reset();
    });
  };
  // attributes that go back have their effect now, and the memory of components begins with them
  reset_parts();
  follow_all_inputs();
  reset_parts();
  // integrators last: they prescribe the motion of states, which have their first positions by then
  root_->for_each<OdeSolver>([](OdeSolver& solver) {
    if (auto* stateful = dynamic_cast<Stateful*>(&solver)) stateful->reset();
  });
  trouble_ = nullptr;
}

void Scene::follow_all_inputs() {
  for (const bool of_contacts : {false, true})
    root_->for_each<Component>([&](Component& component) {
      if (is_contact(component) == of_contacts) component.follow_inputs();
    });
}

SolveReport Scene::step() {
  AnimationLoop* loop = root_->local<AnimationLoop>();
  if (!loop) throw SceneError("the root has no AnimationLoop");
  require_whole();
  keep_motion();
  trouble_ = "a step has failed";
  try {
    const SolveReport report = loop->step();
    trouble_ = nullptr;
    return report;
  } catch (...) {
    restore_motion();
    throw;
  }
}

void Scene::open(ForceField& field, std::span<const int> joints, std::span<const double> crossings) {
  require_whole();
  field.open(joints, crossings);
}

void Scene::require_whole() const {
  if (trouble_)
    throw InputError(fmt::format("{}: the scene continues after reset, or after a state is loaded", trouble_));
}

void Scene::keep_motion() {
  time_before_ = root_->clock().time;
  std::size_t k = 0;
  root_->for_each<MechanicalState>([&](MechanicalState& state) {
    if (k == motion_before_.size()) motion_before_.emplace_back();
    motion_before_[k].positions = state.positions();
    motion_before_[k].velocities = state.velocities();
    ++k;
  });
}

void Scene::restore_motion() {
  root_->clock().time = time_before_;
  auto before = motion_before_.begin();
  root_->for_each<MechanicalState>([&](MechanicalState& state) {
    if (state.num_nodes() == before->positions.rows()) {  // else it has split: then the step had come to its end
      state.positions() = before->positions;
      state.velocities() = before->velocities;
    }
    ++before;
  });
}

namespace {

/// Names of the attributes whose change it follows in the next step.
std::string changes_to_come(Component& component) {
  return component.looks_by_itself() ? std::string() : fmt::format("{}", fmt::join(component.new_inputs(), " "));
}

std::string address(const Component& component) {
  const std::string path = component.node().path();
  return fmt::format("{}{}{} ({})", path, path == "/" ? "" : "/", component.name(), component.class_name());
}

}  // namespace

void Scene::serialize(Archive& archive) {
  if (archive.reads()) return restore(archive);
  require_whole();
  archive(root_->clock().time);
  root_->for_each<Component>([&](Component& component) {
    std::string own_address = address(component), changed = changes_to_come(component);
    auto* stateful = dynamic_cast<Stateful*>(&component);
    std::uint64_t size = stateful ? serialized_size([&](Archive& counting) { stateful->serialize(counting); }) : 0;
    archive(own_address, changed, size);
    if (stateful) stateful->serialize(archive);
  });
}

void Scene::restore(Archive& archive) {
  struct Saved {
    Component& component;
    std::string changed;  // attributes whose change it follows in the next step
    std::span<const std::byte> bytes;
  };
  std::vector<Saved> all;
  trouble_ = "a state could not be read";
  archive(root_->clock().time);
  root_->for_each<Component>([&](Component& component) {
    std::string saved_address, changed;
    std::uint64_t size = 0;
    archive(saved_address, changed, size);
    if (saved_address != address(component))
      throw InputError(fmt::format("{} stands where {} was saved", address(component), saved_address));
    all.push_back({component, std::move(changed), archive.take(size)});
  });

  const auto read = [](const Saved& saved) {
    Archive own(saved.bytes);
    if (auto* stateful = dynamic_cast<Stateful*>(&saved.component)) stateful->serialize(own);
    if (own.rest() != 0)
      throw InputError(
          fmt::format("{} keeps {} bytes, {} were saved", address(saved.component), own.size(), saved.bytes.size()));
  };
  const auto is_body = [](const Saved& saved) {
    const auto* field = dynamic_cast<const ForceField*>(&saved.component);
    return field != nullptr && field->body() != nullptr;
  };
  const auto is_followed = [&](const Saved& saved) {  // AttributeChanges are settings
    return is_body(saved) || dynamic_cast<const MechanicalState*>(&saved.component) ||
           saved.component.description().category == "Settings";
  };
  // bodies first: contact and pressure, which may stand before them, refer to the surface that is left of them
  const auto read_all = [&] {
    for (const bool of_bodies : {true, false})
      for (const Saved& saved : all)
        if (is_body(saved) == of_bodies) read(saved);
  };
  // what follows others is made anew from their state, and its own memory, which may be of another size by then, comes
  // on top of that; what had not followed when it was saved does so in the next step
  for (const bool of_bodies : {true, false})
    for (const Saved& saved : all)
      if (is_followed(saved) && is_body(saved) == of_bodies) read(saved);
  for (const bool of_contacts : {false, true})
    for (const Saved& saved : all)
      if (is_contact(saved.component) == of_contacts && saved.changed.empty()) saved.component.follow_inputs();
  read_all();
  for (const Saved& saved : all) {
    if (saved.component.looks_by_itself()) continue;
    saved.component.accept_inputs();
    for (const std::string_view attribute : split_words(saved.changed)) {
      Data* data = saved.component.find_data(attribute);
      if (!data) throw InputError(fmt::format("{} has no attribute '{}'", address(saved.component), attribute));
      data->forget();
    }
  }
  trouble_ = nullptr;
}

void begin_step(Node& node) {
  for (const bool of_contacts : {false, true})
    node.for_each<Component>([&](Component& component) {
      if (is_contact(component) != of_contacts) return;
      component.follow_inputs();
      component.begin_step();
    });
}

void end_step(Node& node, double dt) {
  node.for_each<Component>([dt](Component& component) { component.end_step(dt); });

  struct Opening {
    ForceField* field;
    std::vector<int> joints = {};
    std::vector<double> crossings = {};
  };
  std::vector<Opening> openings;  // all are found before any opens: that may fail
  node.for_each<Blade>([&](Blade& blade) {
    const std::span<const int> joints = blade.joints();
    if (joints.empty()) return;
    auto of_body = std::ranges::find(openings, &blade.field(), &Opening::field);
    if (of_body == openings.end()) of_body = openings.insert(of_body, {&blade.field()});
    of_body->joints.insert(of_body->joints.end(), joints.begin(), joints.end());
    of_body->crossings.insert(of_body->crossings.end(), blade.crossings().begin(), blade.crossings().end());
  });
  node.for_each<ForceField>([&](ForceField& field) {
    const FlowReport* report = field.flow_report();
    if (!report || report->torn.empty()) return;
    auto of_body = std::ranges::find(openings, &field, &Opening::field);
    if (of_body == openings.end()) of_body = openings.insert(of_body, {&field});
    of_body->joints.insert(of_body->joints.end(), report->torn.begin(), report->torn.end());
    of_body->crossings.resize(of_body->joints.size(), kTorn);
  });
  for (const auto& [field, joints, crossings] : openings) field->open(joints, crossings);
}

namespace {

/// The state of a body, and those that follow it node by node.
std::vector<MechanicalState*> states_that_split(const ForceField& field) {
  std::vector<MechanicalState*> states{field.node().nearest<MechanicalState>()};
  const std::vector<Mapping*> mappings = field.node().root().all<Mapping>();
  for (std::size_t k = 0; k < states.size(); ++k)
    for (const Mapping* mapping : mappings)
      if (mapping->input() == states[k] && mapping->output() && mapping->is_node_by_node())
        states.push_back(mapping->output());
  return states;
}

/// Whether what a component does refers to nodes of a state.
bool refers_to(Component& component, const MechanicalState& state) {
  const auto is_one = [&](std::array<MechanicalState*, 2> states) { return std::ranges::count(states, &state) > 0; };
  const auto* interaction = dynamic_cast<const Interaction*>(&component);
  if (interaction && interaction->states()[0]) return is_one(interaction->states());
  if (const auto* tie = dynamic_cast<const InteractionProjectiveConstraint*>(&component)) return is_one(tie->states());
  if (const auto* mapping = dynamic_cast<const Mapping*>(&component)) return mapping->input() == &state;
  if (dynamic_cast<const OdeSolver*>(&component)) {
    const auto below = component.node().all<MechanicalState>();
    return std::ranges::count(below, &state) > 0;
  }
  const bool acts = dynamic_cast<const ForceField*>(&component) || dynamic_cast<const Mass*>(&component) ||
                    dynamic_cast<const ProjectiveConstraint*>(&component);
  return &component == &state || (acts && acts_on(component, state));
}

}  // namespace

void require_followers(ForceField& field) {
  const std::vector<MechanicalState*> states = states_that_split(field);
  field.node().root().for_each<Component>([&](Component& component) {
    if (component.stage() == Component::Stage::kFailed) return;
    const auto* mapping = dynamic_cast<const Mapping*>(&component);
    if (mapping && mapping->output() == states.front())
      field.reject("is on a state that follows another one: its joints cannot be opened");
    for (const MechanicalState* state : states) {
      if (&component == &field) continue;
      std::string reason;
      const auto* other = dynamic_cast<const ForceField*>(&component);
      if (const auto* follower = dynamic_cast<const FollowsNodes*>(&component))
        reason = follower->cannot_follow(*state, *field.body());
      else if (refers_to(component, *state))
        reason = other && other->body() ? "is a second body on the same nodes" : "does not know of nodes that split";
      if (!reason.empty())
        component.reject(
            fmt::format("{}: no joint of {} '{}' can be opened", reason, field.class_name(), field.name()));
    }
  });
}

void announce_nodes(ForceField& field, std::span<const int> split_from) {
  const std::vector<MechanicalState*> states = states_that_split(field);
  for (MechanicalState* state : states) state->split_by_ = field.body();
  const auto tell = [&](auto is_told) {
    field.node().root().for_each<Component>([&](Component& component) {
      auto* follower = dynamic_cast<FollowsNodes*>(&component);
      if (follower && is_told(component))
        for (MechanicalState* state : states) follower->nodes_changed(*state, split_from);
    });
  };
  const auto is_state = [](Component& component) { return dynamic_cast<MechanicalState*>(&component) != nullptr; };
  const auto is_solver = [](Component& component) { return dynamic_cast<OdeSolver*>(&component) != nullptr; };
  tell(is_state);
  tell([&](Component& component) { return !is_state(component) && !is_solver(component); });
  tell(is_solver);
}

void announce_removed(const ForceField& field, std::span<const int> hexahedra) {
  field.node().root().for_each<Component>([&](Component& component) { component.hexahedra_removed(field, hexahedra); });
}

}  // namespace hexaplast::scene
