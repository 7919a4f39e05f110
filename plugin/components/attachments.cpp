// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "attributes/stock.hpp"
#include "components/between_states.hpp"
#include "components/components.hpp"
#include "components/system_solver.hpp"
#include "hexaplast/base/error.hpp"
#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

/// Pairs of nodes, one of each state, as SOFA ties them. The second one is free to accelerate in no direction, or has
/// half the acceleration of both; after a step half of the distance is taken back, and both have half of the
/// velocities.
class AttachProjectiveConstraint final : public scene::InteractionProjectiveConstraint, public scene::ShowsSprings {
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
    read_factors();
  }

  // Its time integrator, which may stand before it, has asked for its pairs already.
  void bwd_init() override {
    integrator_ = dynamic_cast<SystemSolver*>(&require_one_integrator(*this, states_));
    pairs();
  }

  // What the matrix and the order of the states are made by stays; whether others hold its nodes too, the integrator
  // checks.
  void refresh() override {
    if (boolean("twoWay") != is_two_way_) reject("twoWay", "cannot change during a run");
    read_factors();
    has_pairs_ = has_failed_ = false;
    pairs();
    if (integrator_) integrator_->constraints_changed();
  }

  void serialize(Archive& archive) override {
    pairs();
    std::vector<unsigned char> saved = is_released_;
    archive(saved);
    if (saved.size() != pairs_.size())
      throw InputError(fmt::format("{} tied nodes are saved, there are {}", saved.size(), pairs_.size()));
    is_released_ = std::move(saved);
  }

  void project(OfTwo<Points> field) const override {
    pairs();
    if (!is_active()) return;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto& [first, second, factor] = pairs_[i];
      if (is_released_[i]) continue;
      if (is_two_way_)
        draw_together(field.first.row(first), field.second.row(second), .5 * factor);
      else
        field.second.row(second).setZero();
    }
  }

  void pin(BlockMatrix& A) const override {
    if (!is_active()) return;
    for (std::size_t i = 0; i < pairs_.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        if (!is_released_[i]) A.pin(pairs_[i].second, axis);
  }

  // The first node keeps its position, but not its velocity, in both ways.
  void project_motion(double, OfTwo<Points> x, OfTwo<Points> v) const override {
    pairs();
    if (!is_active()) return;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto& [first, second, factor] = pairs_[i];
      const Eigen::RowVector3d apart = x.second.row(second) - x.first.row(first);
      is_released_[i] = min_distance_ != -1 && apart.norm() > min_distance_;
      if (!is_released_[i]) x.second.row(second) -= .5 * position_factor_ * factor * apart;
    }
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto& [first, second, factor] = pairs_[i];
      if (!is_released_[i]) draw_together(v.first.row(first), v.second.row(second), .5 * velocity_factor_ * factor);
    }
  }

  std::vector<scene::SpringLine> spring_lines() const override {
    std::vector<scene::SpringLine> lines;
    if (!is_active()) return lines;
    const SpringEnds first(*states_[0]), second(*states_[1]);
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const std::optional from = first.at(pairs_[i].first), to = second.at(pairs_[i].second);
      if (from && to && !is_released_[i]) lines.push_back({*from, *to});
    }
    return lines;
  }

 private:
  void read_factors() {
    position_factor_ = real("positionFactor");
    velocity_factor_ = real("velocityFactor");
    min_distance_ = real("minDistance");
    end_time_ = real("endTime");
  }

  struct Pair {
    int first = 0, second = 0;
    double factor = 1;
  };

  template <class Row>
  static void draw_together(Row&& first, Row&& second, double fraction) {
    const Eigen::RowVector3d correction = fraction * (second - first);
    first += correction;
    // by half of it to the very same place: a projection leaves what it has made as it is
    if (fraction == .5)
      second = first;
    else
      second -= correction;
  }

  bool is_active() const { return end_time_ < 0 || end_time_ > node().clock().time; }

  /// Made when they are first asked for: both states have their nodes by then.
  const std::vector<Pair>& pairs() const {
    if (!has_pairs_) const_cast<AttachProjectiveConstraint*>(this)->make_pairs();
    return pairs_;
  }

  void make_pairs() {
    if (has_failed_) throw scene::DependencyFailure();
    has_failed_ = true;
    const std::vector<int> first = indices("indices1", states_[0]->num_nodes()),
                           second = indices("indices2", states_[1]->num_nodes());
    if (first.size() != second.size())
      reject("indices2",
             fmt::format("{} nodes given for {} of indices1, must be as many", second.size(), first.size()));
    std::vector<double> factors = reals("constraintFactor");
    if (factors.empty()) factors.assign(first.size(), 1);
    if (factors.size() != first.size())
      reject("constraintFactor",
             fmt::format("{} values given for {} pairs, must be as many", factors.size(), first.size()));
    if (is_two_way_) {
      require_once("indices1", first);
      for (const double factor : factors)
        if (factor != 0 && factor != 1)
          reject("constraintFactor", fmt::format("{} must be 0 or 1 with twoWay", factor));
    }
    require_once("indices2", second);
    const std::vector<Pair> before = std::exchange(pairs_, {});
    for (std::size_t i = 0; i < first.size(); ++i) pairs_.push_back({first[i], second[i], factors[i]});
    const auto same_nodes = [](const Pair& a, const Pair& b) { return a.first == b.first && a.second == b.second; };
    if (!std::ranges::equal(before, pairs_, same_nodes)) is_released_.assign(pairs_.size(), 0);
    has_pairs_ = true;
    has_failed_ = false;
  }

  void require_once(std::string_view attribute, const std::vector<int>& nodes) {
    std::set<int> known;
    for (const int node : nodes)
      if (!known.insert(node).second) reject(attribute, fmt::format("{} is given twice, must be tied once", node));
  }

  std::array<scene::MechanicalState*, 2> states_ = {};
  SystemSolver* integrator_ = nullptr;
  bool is_two_way_ = false;
  double position_factor_ = 1, velocity_factor_ = 1;
  double min_distance_ = -1;  // [m] -1: any
  double end_time_ = -1;      // [s] below 0: never
  bool has_pairs_ = false, has_failed_ = false;
  std::vector<Pair> pairs_;
  mutable std::vector<unsigned char> is_released_;  // per pair: its nodes were too far apart
};

}  // namespace

void add_attachments(scene::Factory& factory) {
  factory.add<AttachProjectiveConstraint>(attributes::kAttachProjectiveConstraint);
}

}  // namespace hexaplast::components
