// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "components/system_solver.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/spread_nodes.hpp"
#include "scene/interfaces.hpp"
#include "solve/loads.hpp"

namespace hexaplast::components {
namespace {

/// Some nodes with all their copies, held in some directions while it is active.
class NodeConstraint : public scene::ProjectiveConstraint, public scene::Changeable, public scene::FollowsNodes {
 public:
  using ProjectiveConstraint::ProjectiveConstraint;

  void refresh(std::span<const std::string_view>) override {
    init();
    constraints_changed();
  }

  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (acts_on(*this, state)) spread_nodes(state);
  }

  void provide(scene::Data& output) override {
    const std::string_view name = output.attribute().name;
    if (name != "reaction" && name != "reactionTorque") return;
    scene::MechanicalState& state = needed_ready<scene::MechanicalState>();
    auto* supports = dynamic_cast<scene::Supports*>(node().nearest<scene::OdeSolver>());
    if (!supports) reject(name, "is told by EulerImplicitSolver only, as the time integrator");
    supports->keep_support_forces();
    const PointArray forces = supports->support_forces(state);
    if (forces.rows() == 0 && node().clock().time > 0)
      reject(name, "is measured from the next step on: nothing asked for it before, as a Probe does");
    Vec3 sum = Vec3::Zero();
    for (const int node : nodes_) {
      if (forces.rows() == 0) break;
      Vec3 force = Vec3::Zero();
      for (int axis = 0; axis < 3; ++axis)
        if (held_[axis]) force[axis] = forces(node, axis);
      sum += name == "reaction" ? force : Vec3(state.positions().row(node).transpose()).cross(force);
    }
    output.set(std::vector<double>(sum.begin(), sum.end()));
  }

  void fix(NodeMaskRows free) const override {
    if (!is_active()) return;
    for (const int node : nodes_)
      for (int axis = 0; axis < 3; ++axis)
        if (held_[axis]) free(node, axis) = 0;
  }

 protected:
  virtual bool is_active() const { return true; }

  void constraints_changed() {
    if (auto* solver = dynamic_cast<SystemSolver*>(node().nearest<scene::OdeSolver>())) solver->constraints_changed();
  }

  void take_nodes(bool all = false) {
    auto& state = needed_ready<scene::MechanicalState>();
    given_ = indices("indices", state.num_initial_nodes());
    if (all) {
      given_.resize(static_cast<std::size_t>(state.num_initial_nodes()));
      std::iota(given_.begin(), given_.end(), 0);
    }
    spread_nodes(state);
  }
  void spread_nodes(const scene::MechanicalState& state) { nodes_ = parts::spread(given_, state.copies()).nodes; }

  void take_directions(std::string_view attribute) {
    const std::vector<std::int64_t>& given = integers(attribute);
    if (given.size() != 3) reject(attribute, fmt::format("{} numbers given, must be three", given.size()));
    for (int axis = 0; axis < 3; ++axis) held_[axis] = given[axis] == 1;
  }

  std::vector<int> given_;  // initial nodes
  std::vector<int> nodes_;  // all copies of these
  std::array<bool, 3> held_{true, true, true};
};

/// Fixed and PartialFixed.
class FixedConstraint final : public NodeConstraint {
 public:
  using NodeConstraint::NodeConstraint;

  void init() override {
    take_nodes(boolean("fixAll"));
    if (find_data("fixedDirections")) take_directions("fixedDirections");
  }
};

/// Linear and PartialLinear: motion along a history. From the last key time on the nodes are free, whichever linear
/// solver is used (in SOFA assembled matrices keep them).
class KeyedMotion final : public NodeConstraint, public scene::Stateful {
 public:
  using NodeConstraint::NodeConstraint;

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    read();
    anchors_ = state_->positions();
  }

  void bwd_init() override {
    for (const KeyedMotion* other : node().root().all<KeyedMotion>()) {
      if (other == this) return;
      if (other->stage() == Stage::kReady && contradicts(*other))
        remark(scene::Severity::kWarning, {},
               fmt::format("moves nodes that '{}' moves too at that time", other->name()));
    }
  }

  // It goes on from where the nodes began. Those that join in a run begin where they are then.
  void refresh(std::span<const std::string_view>) override {
    std::vector<int> before = nodes_;
    read();
    std::ranges::sort(before);
    if (is_running_)
      for (const int node : nodes_)
        if (!std::ranges::binary_search(before, node)) join(node);
    constraints_changed();
  }

  void begin_step() override { is_running_ = true; }

  void nodes_changed(scene::MechanicalState& state, std::span<const int> split_from) override {
    if (&state != state_) return;
    NodeConstraint::nodes_changed(state, split_from);
    if (split_from.empty()) {
      anchors_ = state.positions();  // those of the beginning; a state that is read has others
      joined_.clear();
      return;
    }
    const auto count = static_cast<int>(anchors_.rows());
    append_rows(split_from, anchors_);
    for (std::size_t i = 0; i < split_from.size(); ++i)
      if (std::ranges::count(joined_, split_from[i]) > 0) joined_.push_back(count + static_cast<int>(i));
  }

  void reset() override {
    is_running_ = false;
    joined_.clear();
    anchors_ = state_->positions();
  }

  void serialize(Archive& archive) override {
    std::vector<int> nodes = given_, joined = joined_;
    PointArray anchors(std::ssize(joined), 3);
    for (std::size_t k = 0; k < joined.size(); ++k) anchors.row(static_cast<Eigen::Index>(k)) = anchors_.row(joined[k]);
    archive(is_running_, nodes, joined, anchors);
    if (!archive.reads()) return;
    const auto is_there = [&](int node) { return node >= 0 && node < anchors_.rows(); };
    const auto is_initial = [&](int node) { return node >= 0 && node < state_->num_initial_nodes(); };
    if (!std::ranges::all_of(nodes, is_initial) || !std::ranges::all_of(joined, is_there) ||
        anchors.rows() != std::ssize(joined) || !anchors.allFinite())
      throw InputError("a prescribed motion is saved of other nodes");
    given_ = std::move(nodes);
    spread_nodes(*state_);
    joined_ = std::move(joined);
    for (std::size_t k = 0; k < joined_.size(); ++k)
      anchors_.row(joined_[k]) = anchors.row(static_cast<Eigen::Index>(k));
  }

  void project_motion(double time, Points x, Points v) const override {
    const KeyPhase phase = phase_at(times_, time);
    if (!lies_between_keys(phase)) return;
    const Eigen::RowVector3d movement = interpolate(phase, movements_), velocity = slope(phase, times_, movements_);
    for (const int node : nodes_)
      for (int axis = 0; axis < 3; ++axis) {
        if (!held_[axis]) continue;
        x(node, axis) = anchors_(node, axis) + movement[axis];
        v(node, axis) = velocity[axis];
      }
  }

 private:
  bool is_active() const override { return lies_between_keys(phase_at(times_, node().clock().time)); }
  bool lies_between_keys(const KeyPhase& phase) const {
    return phase.key >= 0 && phase.key + 1 < static_cast<int>(times_.size());
  }

  bool contradicts(const KeyedMotion& other) const {
    const auto both_hold = [&](int axis) { return held_[axis] && other.held_[axis]; };
    return state_ == other.state_ && times_.front() < other.times_.back() && other.times_.front() < times_.back() &&
           std::ranges::any_of(std::array{0, 1, 2}, both_hold) &&
           std::ranges::find_first_of(nodes_, other.nodes_) != nodes_.end();
  }

  void read() {
    if (find_data("movedDirections")) take_directions("movedDirections");
    movements_ = vectors3("movements");
    times_ = key_times(*this, "keyTimes", "movements", static_cast<std::size_t>(movements_.rows()));
    take_nodes();
  }

  // The latest step has moved the others by what holds at its beginning.
  void join(int node) {
    const scene::Clock& clock = this->node().clock();
    const KeyPhase phase = phase_at(times_, clock.time - clock.dt);
    anchors_.row(node) = state_->positions().row(node);
    if (lies_between_keys(phase)) anchors_.row(node) -= interpolate(phase, movements_);
    if (std::ranges::find(joined_, node) == joined_.end()) joined_.push_back(node);
  }

  scene::MechanicalState* state_ = nullptr;
  std::vector<double> times_;  // [s]
  PointArray movements_;       // [m] one row per time
  PointArray anchors_;         // [m] per node: its position without the movement
  std::vector<int> joined_;    // nodes whose anchors are not their first positions
  bool is_running_ = false;
};

}  // namespace

void add_constraints(scene::Factory& factory) {
  using namespace attributes;
  for (const Description* description :
       std::initializer_list<const Description*>{&kFixedProjectiveConstraint, &kPartialFixedProjectiveConstraint})
    factory.add(*description, [description] { return std::make_unique<FixedConstraint>(*description); });
  for (const Description* description : std::initializer_list<const Description*>{
           &kLinearMovementProjectiveConstraint, &kPartialLinearMovementProjectiveConstraint})
    factory.add(*description, [description] { return std::make_unique<KeyedMotion>(*description); });
}

}  // namespace hexaplast::components
