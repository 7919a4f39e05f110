// SPDX-License-Identifier: LGPL-2.1-or-later
#include <optional>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/mechanical_system.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "hexaplast/solve/newton_raphson.hpp"

namespace hexaplast::components {
namespace {

/// Moves everything of its node and below, by linear systems of a LinearSolver.
class SystemSolver : public scene::OdeSolver {
 public:
  using OdeSolver::OdeSolver;

  // The linear solver and what there is to move may stand anywhere in the node: they are complete when init is done.
  void bwd_init() override {
    linear_solver_ = &linked<scene::LinearSolver>("linearSolver").method();
    for (scene::Component* component : node().all<scene::Component>())
      if (component->stage() == Stage::kFailed) throw scene::Consequence();
    system_.emplace(node());
    system_->project_motion(0);
  }

  void reset() override {
    linear_solver_->reset();
    system_->project_motion(0);
  }

  double kinetic_energy() const override { return system_->kinetic_energy(); }

 protected:
  hexaplast::LinearSolver& linear_solver() { return *linear_solver_; }
  NodeSystem& system() { return *system_; }

 private:
  hexaplast::LinearSolver* linear_solver_ = nullptr;
  std::optional<NodeSystem> system_;
};

class EulerImplicitSolver final : public SystemSolver {
 public:
  EulerImplicitSolver() : SystemSolver(attributes::kEulerImplicitSolver) {}

  void bwd_init() override {
    SystemSolver::bwd_init();
    if (!system().has_mass()) throw InputError("no mass in its node or below, must be at least one");
    euler_.emplace(
        EulerSettings{.rayleigh_mass = real("rayleighMass"), .rayleigh_stiffness = real("rayleighStiffness")});
  }

  SolveReport solve(double time, double dt) override {
    scene::MechanicalState& state = system().state();
    const SolveReport report = euler_->step(system(), linear_solver(), time, dt, state.positions(), state.velocities());
    system().project_motion(time);
    return report;
  }

 private:
  std::optional<ImplicitEuler> euler_;
};

/// Read by the StaticSolver that it serves.
class NewtonRaphsonSolver final : public scene::Component {
 public:
  static constexpr std::string_view kCategory = "NewtonRaphsonSolver";
  NewtonRaphsonSolver() : Component(attributes::kNewtonRaphsonSolver) {}

  NewtonSettings settings() {
    return {.iterations = integer("maxNbIterationsNewton"),
            .relative_successive = real("relativeSuccessiveStoppingThreshold"),
            .relative_initial = real("relativeInitialStoppingThreshold"),
            .absolute_residual = real("absoluteResidualStoppingThreshold"),
            .relative_estimate = real("relativeEstimateDifferenceThreshold"),
            .absolute_estimate = real("absoluteEstimateDifferenceThreshold"),
            .line_search_iterations = integer("maxNbIterationsLineSearch"),
            .line_search_coefficient = real("lineSearchCoefficient"),
            .update_when_diverged = boolean("updateStateWhenDiverged")};
  }
};

class StaticSolver final : public SystemSolver {
 public:
  StaticSolver() : SystemSolver(attributes::kStaticSolver) {}

  void bwd_init() override {
    SystemSolver::bwd_init();
    newton_.emplace(newton_settings());
  }

  // What is always in equilibrium has no velocity.
  SolveReport solve(double time, double) override {
    scene::MechanicalState& state = system().state();
    state.velocities().setZero();
    const NewtonReport found = newton_->solve(system(), linear_solver(), time, state.positions());
    system().project_motion(time);
    return {.iterations = found.linear_iterations,
            .residual = found.iterations == 0 ? 0 : found.residual / found.initial_residual,
            .converged = found.status != NewtonStatus::kNotConverged};
  }

 private:
  NewtonSettings newton_settings() {
    if (is_given("newtonSolver") || node().nearest<NewtonRaphsonSolver>())
      return linked<NewtonRaphsonSolver>("newtonSolver").settings();
    remark(scene::Severity::kWarning, "newtonSolver",
           "no NewtonRaphsonSolver in its node or above: takes one with default settings, a single iteration per step");
    return NewtonRaphsonSolver().settings();
  }

  std::optional<NewtonRaphson> newton_;
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
  factory.add<StaticSolver>(attributes::kStaticSolver);
  factory.add<NewtonRaphsonSolver>(attributes::kNewtonRaphsonSolver);
  factory.add<CGLinearSolver>(attributes::kCGLinearSolver);
  factory.add<SparseLDLSolver>(attributes::kSparseLDLSolver);
}

}  // namespace hexaplast::components
