// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/interfaces.hpp"
#include "scene/visuals.hpp"

namespace hexaplast::components {

/// Knows which state of points follows which state of points or frames.
template <class Above>
class StateMapping : public scene::Mapping {
 public:
  using Mapping::Mapping;

  // When everything has its nodes, and before the solvers above look at it.
  void bwd_init() override {
    output_ = following();
    if (!output_) return carry_visual_model();
    input_ = &followed();
    if (static_cast<scene::State*>(input_) == output_)
      reject("input", "is the mapped state itself: must be another one");
    for (const scene::State* end : {static_cast<scene::State*>(input_), static_cast<scene::State*>(output_)})
      if (end->stage() != Stage::kReady) throw scene::DependencyFailure();
    connect(*input_, *output_);
  }

  scene::State* input() const override { return input_; }
  scene::State* output() const override { return output_; }

 protected:
  virtual void connect(Above& above, scene::MechanicalState& below) = 0;

  /// An OglModel that follows: pictures look where its points lie; there is nothing to do in a step.
  virtual void carry(scene::VisualModel& model) { model.carry(); }

  scene::VisualModel* following_visually() { return at_output<scene::VisualModel>(); }

  Above& followed() {
    if (is_given("input")) return linked<Above>("input");
    const scene::Node* above = node().parent();
    auto* state = dynamic_cast<Above*>(above ? above->nearest<scene::State>() : nullptr);
    if (!state) reject_input();
    return *state;
  }

  Above* input_ = nullptr;
  scene::MechanicalState* output_ = nullptr;

 private:
  [[noreturn]] virtual void reject_input() { reject("needs a MechanicalState in a node above"); }

  scene::MechanicalState* following() {
    if (auto* state = at_output<scene::State>()) {
      if (auto* points = dynamic_cast<scene::MechanicalState*>(state)) return points;
      reject("output", "leads to rigid frames, must lead to a state of points");
    }
    return nullptr;
  }

  template <class T>
  T* at_output() {
    scene::Object* target = find_data("output")->target();
    if (!target) return node().template local<T>();
    if (const auto* holder = dynamic_cast<scene::Node*>(target)) return holder->template local<T>();
    return dynamic_cast<T*>(target);
  }

  void carry_visual_model() {
    if (scene::VisualModel* model = following_visually()) return carry(*model);
    remark(scene::Severity::kNote, "output", "leads to no mechanical state and to no OglModel: ignored here");
  }
};

}  // namespace hexaplast::components
