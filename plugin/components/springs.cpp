// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/springs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "attributes/stock.hpp"
#include "components/between_states.hpp"
#include "components/cells.hpp"
#include "components/components.hpp"
#include "parts/spread_nodes.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {
namespace {

/// Springs between nodes of its state, or of two states of which not both are it.
class SpringForceField final : public scene::ForceField,
                               public scene::Interaction,
                               public scene::Changeable,
                               public scene::ShowsSprings,
                               public scene::FollowsNodes {
 public:
  SpringForceField() : ForceField(attributes::kSpringForceField) {}

  std::array<scene::MechanicalState*, 2> states() const override { return states_; }

  void init() override {
    const std::array given = {&linked<scene::MechanicalState>("object1"), &linked<scene::MechanicalState>("object2")};
    const auto* own = node().nearest<scene::MechanicalState>();
    rayleigh_stiffness_ = real("rayleighStiffness");
    if (given[0] != own || given[1] != own)
      states_ = given;
    else
      make_springs();
  }

  // When both states have their nodes, which may stand behind it.
  void bwd_init() override {
    if (states_[0]) {
      require_one_integrator(*this, states_);
      make_springs();
    }
  }

  void refresh(std::span<const std::string_view>) override {
    rayleigh_stiffness_ = real("rayleighStiffness");
    make_springs();
  }

  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (&state == &end(0) || &state == &end(1)) spread_springs();
  }

  void add_force(double, ConstPoints x, ConstPoints v, Points f) override { springs_.add_force(x, v, f); }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    springs_.add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override { springs_.add_stiffness_blocks(factor, A); }
  void add_force(double, const Pair<ConstPoints>& x, const Pair<ConstPoints>& v, Pair<Points> f) override {
    springs_.add_force(x, v, f);
  }
  void add_stiffness_product(double factor, const Pair<ConstPoints>& dx, Pair<Points> df) const override {
    springs_.add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A, std::array<int, 2> first_nodes) const override {
    springs_.add_stiffness_blocks(factor, A, first_nodes);
  }
  bool is_in_matrix() const override { return !springs_.springs().empty(); }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  std::vector<scene::SpringLine> spring_lines() const override {
    const SpringEnds first(end(0)), second(end(1));
    std::vector<scene::SpringLine> lines;
    for (const Spring& spring : springs_.springs()) {
      const std::optional from = first.at(spring.a), to = second.at(spring.b);
      if (from && to) lines.push_back({*from, *to, (*to - *from).norm() < (1 - kTaut) * spring.rest_length});
    }
    return lines;
  }

 private:
  static constexpr double kTaut = 1e-6;  // of the rest length: rounding does not make a spring slack

  void make_springs() {
    if (!states_[0]) needed_ready<scene::MechanicalState>();
    given_ = make({end(0).num_initial_nodes(), end(1).num_initial_nodes()});
    spread_springs();
  }

  scene::MechanicalState& end(int k) const {
    return states_[k] ? *states_[k] : *node().nearest<scene::MechanicalState>();
  }

  /// Between all copies of the two nodes, each with the product of their shares.
  void spread_springs() {
    std::vector<Spring> springs;
    for (const Spring& spring : given_) {
      const auto first = parts::spread(std::array{spring.a}, end(0).copies()),
                 second = parts::spread(std::array{spring.b}, end(1).copies());
      for (std::size_t i = 0; i < first.nodes.size(); ++i)
        for (std::size_t j = 0; j < second.nodes.size(); ++j) {
          Spring& one = springs.emplace_back(spring);
          one.a = first.nodes[i];
          one.b = second.nodes[j];
          one.stiffness *= first.shares[i] * second.shares[j];
          one.damping *= first.shares[i] * second.shares[j];
        }
    }
    springs_ = Springs(std::move(springs), {end(0).num_nodes(), end(1).num_nodes()});
  }

  std::vector<Spring> make(std::array<int, 2> num_nodes) {
    std::vector<Spring> springs = from_lists(num_nodes);
    if (is_given("spring")) springs = whole(num_nodes);
    for (Spring& spring : springs) spring.only_pulls = boolean("elongationOnly");
    return springs;
  }

  std::vector<Spring> whole(std::array<int, 2> num_nodes) {
    const std::vector<double>& numbers = reals("spring");
    if (numbers.size() % 5 != 0) reject("spring", fmt::format("{} numbers given, must be groups of 5", numbers.size()));
    std::vector<Spring> springs;
    for (auto n = numbers.begin(); n != numbers.end(); n += 5) {
      for (int end = 0; end < 2; ++end)
        if (n[end] != std::floor(n[end]) || n[end] < 0 || n[end] >= num_nodes[end])
          reject("spring",
                 fmt::format("{} is not a node{}, must be a whole number from 0 to {}", n[end],
                             states_[end] ? fmt::format(" of '{}'", states_[end]->name()) : "", num_nodes[end] - 1));
      for (int i = 2; i < 5; ++i)
        if (n[i] < 0) reject("spring", fmt::format("{} must be at least 0", n[i]));
      springs.push_back({static_cast<int>(n[0]), static_cast<int>(n[1]), n[2], n[3], n[4]});
    }
    return springs;
  }

  std::vector<Spring> from_lists(std::array<int, 2> num_nodes) {
    const std::vector<int> first = indices("indices1", num_nodes[0]), second = indices("indices2", num_nodes[1]);
    if (first.size() != second.size())
      reject("indices2",
             fmt::format("{} nodes given for {} of indices1, must be as many", second.size(), first.size()));
    std::vector<Spring> springs(first.size());
    const auto stiffness = values("stiffness", first.size()), damping = values("damping", first.size()),
               lengths = values("lengths", first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      springs[i] = {first[i], second[i], stiffness[i], damping[i], lengths[i]};
    return springs;
  }

  std::vector<double> values(const char* name, std::size_t count) {
    std::vector<double> given = reals(name);
    if (given.size() == 1) given.resize(count, given[0]);
    if (given.size() != count)
      reject(name, fmt::format("{} values given for {} springs, must be one or as many", given.size(), count));
    return given;
  }

  std::array<scene::MechanicalState*, 2> states_ = {};  // null: one state, the nearest
  std::vector<Spring> given_;                           // between initial nodes
  Springs springs_;
  double rayleigh_stiffness_ = 0;
};

/// To the rest positions, or to where another state is at the moment.
class RestShapeSpringsForceField final : public scene::ForceField,
                                         public scene::Changeable,
                                         public scene::ShowsSprings,
                                         public scene::FollowsNodes {
 public:
  RestShapeSpringsForceField() : ForceField(attributes::kRestShapeSpringsForceField) {}

  void init() override {
    state_ = &needed_ready<scene::MechanicalState>();
    given_ = indices("points", state_->num_initial_nodes());
    if (given_.empty()) {
      given_.resize(static_cast<std::size_t>(state_->num_initial_nodes()));
      std::iota(given_.begin(), given_.end(), 0);
    }
    given_stiffness_ = reals("stiffness");
    if (given_stiffness_.size() == 1) given_stiffness_.resize(given_.size(), given_stiffness_[0]);
    if (given_stiffness_.size() != given_.size())
      reject("stiffness", fmt::format("{} values given for {} nodes, must be one or as many", given_stiffness_.size(),
                                      given_.size()));
    spread_springs();
    rayleigh_stiffness_ = real("rayleighStiffness");
    if (is_given("external_points") && !is_given("external_rest_shape"))
      reject("external_points", "given without external_rest_shape, the state that has them");
  }

  // When the other state has its points, which may stand behind it.
  void bwd_init() override {
    if (!is_given("external_rest_shape")) return;
    external_ = &linked<scene::MechanicalState>("external_rest_shape");
    const int num_points = external_->num_initial_nodes();
    given_anchors_ = indices("external_points", num_points);
    if (!is_given("external_points")) {
      given_anchors_.resize(static_cast<std::size_t>(num_points));
      std::iota(given_anchors_.begin(), given_anchors_.end(), 0);
    }
    if (given_anchors_.size() != given_.size())
      reject(is_given("external_points") ? "external_points" : "external_rest_shape",
             fmt::format("{} points of '{}' for {} nodes, must be as many", given_anchors_.size(), external_->name(),
                         given_.size()));
    spread_springs();
  }

  void nodes_changed(scene::MechanicalState& state, std::span<const int>) override {
    if (&state == state_) spread_springs();
  }

  void refresh(std::span<const std::string_view>) override {
    init();
    bwd_init();
  }

  // The other state may move before this one does.
  void begin_step() override {
    follow_anchors();
    is_in_step_ = true;
  }
  void end_step(double) override { is_in_step_ = false; }

  void add_force(double, ConstPoints x, ConstPoints, Points f) override {
    if (!is_in_step_) follow_anchors();
    add_anchor_forces(nodes_, stiffness_, external_ ? rest_ : state_->rest_positions(), x, f);
  }
  void add_stiffness_product(double factor, ConstPoints dx, Points df) const override {
    for (std::size_t i = 0; i < nodes_.size(); ++i) df.row(nodes_[i]) -= factor * stiffness_[i] * dx.row(nodes_[i]);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A) const override {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      A.add(nodes_[i], nodes_[i], -factor * stiffness_[i] * Mat3::Identity());
  }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_; }

  std::vector<scene::SpringLine> spring_lines() const override {
    const SpringEnds ends(*state_);
    std::vector<scene::SpringLine> lines;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Vec3 to =
          external_ ? Vec3(external_->positions().row(anchors_[i])) : Vec3(state_->rest_positions().row(nodes_[i]));
      if (const std::optional from = ends.at(nodes_[i])) lines.push_back({*from, to});
    }
    return lines;
  }

 private:
  void follow_anchors() {
    for (std::size_t i = 0; i < anchors_.size(); ++i) rest_.row(nodes_[i]) = external_->positions().row(anchors_[i]);
  }

  /// One to each copy of a node, by its share. An anchor keeps its number.
  void spread_springs() {
    const parts::SpreadNodes spread = parts::spread(given_, state_->copies());
    nodes_ = spread.nodes;
    stiffness_.clear();
    anchors_.clear();
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto entry = static_cast<std::size_t>(spread.entries[i]);
      stiffness_.push_back(spread.shares[i] * given_stiffness_[entry]);
      if (!given_anchors_.empty()) anchors_.push_back(given_anchors_[entry]);
    }
    rest_ = state_->rest_positions();
  }

  scene::MechanicalState* state_ = nullptr;
  std::vector<int> given_, given_anchors_;  // initial nodes, and those of the external state
  std::vector<double> given_stiffness_;     // [N/m] of each
  std::vector<int> nodes_;
  std::vector<double> stiffness_;               // [N/m] of each
  scene::MechanicalState* external_ = nullptr;  // null: the rest positions count
  std::vector<int> anchors_;                    // node of the external state for each of the nodes
  PointArray rest_;                             // [m] where the external state has them, at the beginning of a step
  bool is_in_step_ = false;
  double rayleigh_stiffness_ = 0;
};

}  // namespace

void add_springs(scene::Factory& factory) {
  factory.add<SpringForceField>(attributes::kSpringForceField);
  factory.add<RestShapeSpringsForceField>(attributes::kRestShapeSpringsForceField);
}

}  // namespace hexaplast::components
