// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <optional>
#include <set>
#include <vector>

#include "attributes/stock.hpp"
#include "components/between_states.hpp"
#include "components/components.hpp"
#include "components/system_solver.hpp"
#include "hexaplast/mesh/node_copies.hpp"
#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

/// Pairs of nodes, one of each state, as SOFA ties them. The second one is free to accelerate in no direction, or has
/// half the acceleration of both; after a step half of the distance is taken back, and both have half of the
/// velocities.
class AttachProjectiveConstraint final : public scene::InteractionProjectiveConstraint,
                                         public scene::Changeable,
                                         public scene::ShowsSprings,
                                         public scene::FollowsNodes {
 public:
  AttachProjectiveConstraint() : InteractionProjectiveConstraint(attributes::kAttachProjectiveConstraint) {}

  std::array<scene::MechanicalState*, 2> states() const override { return states_; }
  bool couples() const override { return is_two_way_; }

  void init() override {
    for (int end = 0; end < 2; ++end) {
      const std::string_view object = end == 0 ? "object1" : "object2";
      states_[end] = &linked<scene::MechanicalState>(object);
    }
    if (states_[0] == states_[1])
      reject("object2", fmt::format("leads to '{}', as object1 does: must lead to another state", states_[1]->name()));
    is_two_way_ = boolean("twoWay");
  }

  // Its time integrator, which may stand before it, has asked for its pairs already.
  void bwd_init() override {
    integrator_ = dynamic_cast<SystemSolver*>(&require_one_integrator(*this, states_));
    pairs();
  }

  // What the matrix and the order of the states are made by stays; whether others hold its nodes too, the integrator
  // checks.
  void refresh(std::span<const std::string_view> changed) override {
    for (const std::string_view attribute : changed)
      if (!may_change(attribute)) reject(attribute, "cannot change during a run");
    has_pairs_ = has_failed_ = false;
    pairs();
    if (integrator_) integrator_->constraints_changed();
  }

  bool may_change(std::string_view attribute) const override { return attribute != "twoWay"; }

  // The first node keeps its number. All copies of the second one follow it; tied in both ways, one is tied to one.
  void nodes_changed(scene::MechanicalState& state, std::span<const int> split_from) override {
    if (!has_pairs_ || (&state != states_[0] && &state != states_[1])) return;
    spread_pairs();
    if (!is_two_way_ || split_from.empty() || has_remarked_) return;
    for (const Tie& pair : given_)
      for (int end = 0; end < 2 && !has_remarked_; ++end) {
        const int node = end == 0 ? pair.first : pair.second;
        if (!states_[end]->copies() || states_[end]->copies()->of(node).size() == 1) continue;
        has_remarked_ = true;
        remark(scene::Severity::kWarning, "twoWay",
               fmt::format("node {} of '{}' has split: one copy of it stays tied", node, states_[end]->name()));
      }
  }

  void project(Pair<Points> field) const override {
    for (const auto& [first, second] : pairs()) draw_together(field.first.row(first), field.second.row(second));
  }

  void fix(NodeMaskRows second) const override {
    for (const Tie& pair : pairs()) second.row(pair.second).setZero();
  }

  // The first node keeps its position, but not its velocity, in both ways.
  void project_motion(double, Pair<Points> x, Pair<Points> v) const override {
    for (const auto& [first, second] : pairs())
      x.second.row(second) -= .5 * (x.second.row(second) - x.first.row(first));
    for (const auto& [first, second] : pairs()) draw_together(v.first.row(first), v.second.row(second));
  }

  std::vector<scene::SpringLine> spring_lines() const override {
    std::vector<scene::SpringLine> lines;
    const SpringEnds first(*states_[0]), second(*states_[1]);
    for (const Tie& pair : pairs_) {
      const std::optional from = first.at(pair.first), to = second.at(pair.second);
      if (from && to) lines.push_back({*from, *to});
    }
    return lines;
  }

 private:
  struct Tie {
    int first = 0, second = 0;
  };

  /// To the very same place: a projection leaves what it has made as it is.
  template <class Row>
  static void draw_together(Row&& first, Row&& second) {
    first += .5 * (second - first);
    second = first;
  }

  /// Made when they are first asked for: both states have their nodes by then.
  const std::vector<Tie>& pairs() const {
    if (!has_pairs_) const_cast<AttachProjectiveConstraint*>(this)->make_pairs();
    return pairs_;
  }

  void make_pairs() {
    if (has_failed_) throw scene::DependencyFailure();
    has_failed_ = true;
    const std::vector<int> first = indices("indices1", states_[0]->num_initial_nodes()),
                           second = indices("indices2", states_[1]->num_initial_nodes());
    if (first.size() != second.size())
      reject("indices2",
             fmt::format("{} nodes given for {} of indices1, must be as many", second.size(), first.size()));
    if (is_two_way_) require_once("indices1", first);
    require_once("indices2", second);
    given_.clear();
    for (std::size_t i = 0; i < first.size(); ++i) given_.push_back({first[i], second[i]});
    spread_pairs();
    has_pairs_ = true;
    has_failed_ = false;
  }

  void spread_pairs() {
    pairs_ = given_;
    const NodeCopies* copies = is_two_way_ ? nullptr : states_[1]->copies();
    if (!copies) return;
    pairs_.clear();
    for (const Tie& pair : given_)
      for (const int copy : copies->of(pair.second)) pairs_.push_back({pair.first, copy});
  }

  void require_once(std::string_view attribute, const std::vector<int>& nodes) {
    std::set<int> known;
    for (const int node : nodes)
      if (!known.insert(node).second) reject(attribute, fmt::format("{} is given twice, must be tied once", node));
  }

  std::array<scene::MechanicalState*, 2> states_ = {};
  SystemSolver* integrator_ = nullptr;
  bool is_two_way_ = false;
  bool has_pairs_ = false, has_failed_ = false;
  bool has_remarked_ = false;
  std::vector<Tie> given_;  // of initial nodes
  std::vector<Tie> pairs_;
};

}  // namespace

void add_attachments(scene::Factory& factory) {
  factory.add<AttachProjectiveConstraint>(attributes::kAttachProjectiveConstraint);
}

}  // namespace hexaplast::components
