// SPDX-License-Identifier: LGPL-2.1-or-later
#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/mechanical_system.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"

namespace hexaplast::components {
namespace {

class EulerImplicitSolver final : public scene::OdeSolver {
 public:
  EulerImplicitSolver() : OdeSolver(attributes::kEulerImplicitSolver) {}

  // The linear solver and what there is to move may stand anywhere in the node: they are complete when init is done.
  void bwd_init() override {
    linear_solver_ = &linked<scene::LinearSolver>("linearSolver").method();
    euler_.emplace(
        EulerSettings{.rayleigh_mass = real("rayleighMass"), .rayleigh_stiffness = real("rayleighStiffness")});
    for (scene::Component* component : node().all<scene::Component>())
      if (component->stage() == Stage::kFailed) throw scene::Consequence();
    system_.emplace(node());
    system_->project_motion(0);
  }

  SolveReport solve(double time, double dt) override {
    scene::MechanicalState& state = system_->state();
    const SolveReport report = euler_->step(*system_, *linear_solver_, time, dt, state.positions(), state.velocities());
    system_->project_motion(time);
    return report;
  }

  void reset() override {
    linear_solver_->reset();
    system_->project_motion(0);
  }

  double kinetic_energy() const override { return system_->kinetic_energy(); }

 private:
  hexaplast::LinearSolver* linear_solver_ = nullptr;
  std::optional<ImplicitEuler> euler_;
  std::optional<NodeSystem> system_;
};

class CGLinearSolver final : public scene::LinearSolver {
 public:
  CGLinearSolver() : LinearSolver(attributes::kCGLinearSolver) {}

  void init() override {
    solver_.emplace(ConjugateGradientSettings{.iterations = integer("iterations"),
                                              .tolerance = real("tolerance"),
                                              .threshold = real("threshold"),
                                              .warm_start = boolean("warmStart")});
  }
  hexaplast::LinearSolver& method() override { return *solver_; }

 private:
  std::optional<ConjugateGradients> solver_;
};

class SparseLDLSolver final : public scene::LinearSolver {
 public:
  SparseLDLSolver() : LinearSolver(attributes::kSparseLDLSolver) {}
  hexaplast::LinearSolver& method() override { return solver_; }

 private:
  CholeskySolver solver_;
};

}  // namespace

void add_solvers(scene::Factory& factory) {
  factory.add<EulerImplicitSolver>(attributes::kEulerImplicitSolver);
  factory.add<CGLinearSolver>(attributes::kCGLinearSolver);
  factory.add<SparseLDLSolver>(attributes::kSparseLDLSolver);
}

}  // namespace hexaplast::components
