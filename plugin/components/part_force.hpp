// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "components/between_states.hpp"
#include "components/cells.hpp"
#include "components/part.hpp"
#include "parts/force.hpp"
#include "scene/factory.hpp"
#include "scene/interfaces.hpp"

/// Parts that are forces (parts/force.hpp) as force fields of a scene.
namespace hexaplast::components {

template <class Part>
using BaseOfPart = std::conditional_t<Part::kNumStates == 1, scene::ForceField, scene::InteractionForceField>;

/// The value of an output.
inline scene::Value shown(const Vec3& vector) { return std::vector<double>(vector.begin(), vector.end()); }
inline scene::Value shown(std::vector<double> numbers) { return numbers; }
inline scene::Value shown(const PointArray& points) { return flattened(points); }
inline scene::Value shown(double number) { return std::vector<double>{number}; }
inline scene::Value shown(int count) { return std::vector<double>{1.0 * count}; }
inline scene::Value shown(std::span<const int> nodes) { return std::vector<std::int64_t>(nodes.begin(), nodes.end()); }

template <class Part, class Verbs = typename BaseOfPart<Part>::Verbs>
class PartField;

/// What those on one state and those between two have in common.
template <class Part, class In, class Out, class... FirstNodes>
class PartField<Part, Forces<In, Out, FirstNodes...>>
    : public BaseOfPart<Part>, public scene::Changeable, public scene::Stateful, public scene::FollowsNodes {
 public:
  PartField() : BaseOfPart<Part>(Part::description()) {}

  void init() override {
    if constexpr (Part::kNumStates == 1) {
      states_.fill(&this->template needed_ready<scene::MechanicalState>());
    } else {
      states_[0] = &this->template linked<scene::MechanicalState>("object1");
      states_[1] = this->is_given("object2") ? &this->template linked<scene::MechanicalState>("object2") : states_[0];
    }
    if constexpr (!Part::kIsContact) make();
  }

  // Bodies and integrators may be declared later.
  void bwd_init() override {
    if constexpr (Part::kIsContact) make();
  }

  void refresh(std::span<const std::string_view>) override {
    accepted(*this, [&] { part_->set_options(options()); });
    say_warnings();
  }

  void nodes_changed(scene::MechanicalState& state, std::span<const int> split_from) override {
    for (int k = 0; k < Part::kNumStates; ++k)
      if (states_[k] == &state) part_->nodes_changed(k, *state.copies(), split_from);
  }

  void begin_step() override {
    const scene::Clock& clock = this->node().clock();
    const Step step{.time = clock.time,
                    .dt = clock.dt,
                    .rayleigh_stiffness = Part::kIsContact ? integrator_->real("rayleighStiffness") : 0};
    accepted(*this, [&] { part_->begin_step(step, positions(), of_both(&scene::MechanicalState::velocities)); });
    pass_on(*this, part_->take_warnings());
  }
  void end_step(double) override {
    part_->end_step(positions());
    pass_on(*this, part_->take_warnings());
  }
  void reset() override { part_->reset(); }
  void serialize(Archive& archive) override { part_->serialize(archive); }

  void add_force(double time, In x, In v, Out f) override { part_->add_force(time, x, v, f); }
  void add_stiffness_product(double factor, In dx, Out df) const override {
    part_->add_stiffness_product(factor, dx, df);
  }
  void add_stiffness_blocks(double factor, BlockMatrix& A, FirstNodes... first) const override {
    part_->add_stiffness_blocks(factor, A, {first...});
  }
  void add_damping_product(double factor, In dx, Out df) const override { part_->add_damping_product(factor, dx, df); }
  void add_damping_blocks(double factor, BlockMatrix& A, FirstNodes... first) const override {
    part_->add_damping_blocks(factor, A, {first...});
  }
  bool is_in_matrix() const override { return part_->is_in_matrix(); }
  double rayleigh_stiffness() const override { return rayleigh_stiffness_ + part_->rayleigh_stiffness(); }
  bool is_one_sided() const override { return Part::kIsContact; }
  bool release(In x_end, In v_end) override { return part_->release(x_end, v_end); }

  void provide(scene::Data& output) override {
    if (!part_) return;
    Part::outputs([&](std::string_view name, const auto& of) {
      if (output.attribute().name == name) output.set(shown(std::invoke(of, std::as_const(*part_))));
    });
  }

 protected:
  const Part& part() const { return *part_; }

  std::array<scene::MechanicalState*, 2> states_ = {};  // the same one twice where there is one

 private:
  void make() {
    parts::Surroundings around;
    if constexpr (Part::kIsContact) {
      const Touching touching = find_touching(*this, std::span(states_).first(Part::kNumStates));
      integrator_ = touching.integrator;
      around.bodies = touching.bodies;
    }
    for (std::size_t k = 0; k < 2; ++k) around.num_nodes[k] = states_[k]->num_initial_nodes();
    accepted(*this, [&] {
      part_.emplace(options(), around);
      for (int k = 0; k < Part::kNumStates; ++k)
        if (const NodeCopies* copies = states_[k]->copies()) part_->nodes_changed(k, *copies, {});
      part_->look_at_start(this->node().clock().time, positions());
    });
    say_warnings();
  }

  typename Part::Options options() {
    if (this->find_data("rayleighStiffness")) rayleigh_stiffness_ = this->real("rayleighStiffness");
    return read_options<typename Part::Options>(*this);
  }

  void say_warnings() {
    if constexpr (Part::kNumStates == 2) warn_of_same_pair();
    pass_on(*this, part_->take_warnings());
  }

  /// Once, of another active contact between the same bodies that was there before.
  void warn_of_same_pair() {
    if (has_warned_of_pair_ || !part_->is_active()) return;
    for (const PartField* other : this->node().root().template all<PartField>()) {
      if (other == this || !other->part_ || other->has_warned_of_pair_ || !other->part_->is_active() ||
          !std::ranges::is_permutation(states_, other->states_))
        continue;
      has_warned_of_pair_ = true;
      part_->warn_of_same_pair(other->name());
      return;
    }
  }

  Pair<ConstPoints> of_both(PointArray& (scene::MechanicalState::*field)()) const {
    return {ConstPoints((states_[0]->*field)()), ConstPoints((states_[1]->*field)())};
  }
  Pair<ConstPoints> positions() const { return of_both(&scene::MechanicalState::positions); }

  std::optional<Part> part_;
  scene::OdeSolver* integrator_ = nullptr;  // of contact
  double rayleigh_stiffness_ = 0;           // [s] given to this field
  bool has_warned_of_pair_ = false;
};

/// A part on one state.
template <class Part>
class PartForce : public PartField<Part>, public scene::Load {
 public:
  void add_load(double time, ConstPoints x, ConstPoints v, Points f) const override {
    this->part().add_load(time, x, v, f);
  }
  bool add_operator(double factor, MatrixFreeSystem& system) const override {
    return this->part().add_stiffness_diagonal(factor, system.diagonal);
  }
  void add_damping_diagonal(double factor, Points diagonal) const override {
    this->part().add_damping_diagonal(factor, diagonal);
  }
  std::span<const int> loaded_nodes() const override { return this->part().loaded_nodes(); }
};

/// A part between two states.
template <class Part>
class PartInteraction final : public PartField<Part> {
 public:
  std::array<scene::MechanicalState*, 2> states() const override { return this->states_; }
};

/// Adds them under the name that the attributes of the part have.
template <class Part>
void add_force(scene::Factory& factory) {
  using Field = std::conditional_t<Part::kNumStates == 1, PartForce<Part>, PartInteraction<Part>>;
  factory.add<Field>(Part::description());
}

}  // namespace hexaplast::components
