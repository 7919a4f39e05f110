// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "scene/scene.hpp"

namespace hexaplast::components {
namespace {

class DefaultAnimationLoop final : public scene::AnimationLoop {
 public:
  DefaultAnimationLoop() : AnimationLoop(attributes::kDefaultAnimationLoop) {}

  void bwd_init() override {
    solvers_ = node().all<scene::OdeSolver>();
    for (scene::MechanicalState* state : scene::independent_states(node())) {
      if (state->node().nearest<scene::OdeSolver>()) continue;
      if (solvers_.empty()) state->reject("nothing moves it: needs an OdeSolver in its node or above");
      state->remark(scene::Severity::kWarning, {}, "nothing moves it: no OdeSolver in its node or above");
    }
    for (scene::OdeSolver* solver : solvers_) {
      const scene::Node* above = solver->node().parent();
      const scene::OdeSolver* other = above ? above->nearest<scene::OdeSolver>() : nullptr;
      if (!other) other = solver->node().local<scene::OdeSolver>();
      if (other != solver)
        solver->reject(
            fmt::format("{} '{}' moves everything in its node and below already", other->class_name(), other->name()));
    }
  }

  SolveReport step() override {
    scene::Clock& clock = node().clock();
    scene::begin_step(node());

    SolveReport total;
    for (scene::OdeSolver* solver : solvers_) {
      const SolveReport report = solver->solve(clock.time, clock.dt);
      total.iterations += report.iterations;
      total.residual = std::max(total.residual, report.residual);
      total.of_newton = total.of_newton || (report.of_newton && !report.converged);
      total.converged = total.converged && report.converged;
      total.at_threshold = total.at_threshold || report.at_threshold;
      if (report.iterations > 0) total.preconditioner = report.preconditioner;
    }

    clock.time += clock.dt;
    scene::end_step(node(), clock.dt);
    return total;
  }

 private:
  std::vector<scene::OdeSolver*> solvers_;
};

}  // namespace

void add_animation_loop(scene::Factory& factory) {
  factory.add<DefaultAnimationLoop>(attributes::kDefaultAnimationLoop);
}

}  // namespace hexaplast::components
