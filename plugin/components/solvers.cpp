// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "attributes/parts.hpp"
#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "components/system_solver.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "hexaplast/solve/energy_balance.hpp"
#include "hexaplast/solve/newton_raphson.hpp"
#include "parts/multigrid_cg.hpp"
#include "scene/interfaces.hpp"
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
  bool needs_matrix() override { return true; }

 private:
  CholeskySolver solver_;
};

/// Ours: ends when the answer is as good as asked for.
class MultigridCGLinearSolver final : public scene::LinearSolver {
 public:
  MultigridCGLinearSolver() : LinearSolver(attributes::kMultigridCGLinearSolver) {}

  void init() override {
    solver_.emplace(
        accepted(*this, [&] { return parts::MultigridCG(read_options<parts::MultigridCGOptions>(*this)); }));
  }
  hexaplast::LinearSolver& method() override { return solver_->solver(); }
  void heed(const SolveReport& report) override { pass_on(*this, solver_->heed(report)); }

 private:
  std::optional<parts::MultigridCG> solver_;
};

class EulerImplicitSolver final : public SystemSolver, public scene::Supports {
 public:
  EulerImplicitSolver() : SystemSolver(attributes::kEulerImplicitSolver) {}

  void bwd_init() override {
    SystemSolver::bwd_init();
    system().require_mass();
    const EulerSettings settings = euler_settings();
    SolverMemory kept = euler_ ? std::move(euler_->memory()) : SolverMemory();  // bwd_init comes again: Scene::add
    has_inertia_ = !settings.first_order;
    euler_.emplace(settings);
    euler_->memory() = std::move(kept);
    if (balance_ || keeps_supports_) euler_->measure_energy();
    warn_of_growing_vibrations(settings);
  }

  double kinetic_energy() const override { return has_inertia_ ? SystemSolver::kinetic_energy() : 0; }

  SolveReport solve(double time, double dt) override {
    update_balance();
    const SolveReport report = heeded(
        system().advance([&](Points x, Points v) { return euler_->step(system(), linear_solver(), time, dt, x, v); }));
    if (keeps_supports_) support_forces_ = euler_->support_forces();
    if (!balance_) {
      system().project_motion(time);
      return report;
    }
    system().follow();
    balance_->add_step(euler_->energy(), kinetic_energy(), system().elastic_energy(), system().recovery_work());
    stepped_to_ = system().positions();
    system().project_motion(time);
    balance_->add_motion_of_supports(
        kinetic_energy(), system().positions() == stepped_to_ ? balance_->elastic : system().elastic_energy());
    pending_ = Pending::kFlow;
    return report;
  }

  SolveReport try_step(double time, double dt) override {
    return tried([&](Points x, Points v, LinearSolver& solver) {
      ImplicitEuler euler(euler_settings());
      euler.memory().is_first = false;  // a step like those that follow
      return euler.step(system(), solver, time, dt, x, v);
    });
  }

  void reset() override {
    SystemSolver::reset();
    pending_ = Pending::kBeginning;
    support_forces_.resize(0, 3);
  }

  void keep_support_forces() override {
    if (euler_) euler_->measure_energy();  // otherwise when it is made
    keeps_supports_ = true;
  }
  PointArray support_forces(const scene::MechanicalState& state) override {
    return support_forces_.rows() == 0 ? support_forces_ : PointArray(system().rows_of_state(state, support_forces_));
  }

  void keep_energy_balance() override {
    euler_->measure_energy();
    balance_.emplace();
    pending_ = Pending::kBeginning;
  }

  const EnergyBalance* energy_balance() override {
    update_balance();
    return balance_ ? &*balance_ : nullptr;
  }

  void body_changes() override {
    if (!balance_ || pending_ == Pending::kBeginning) return;
    update_balance();
    pending_ = Pending::kChange;
  }

  void serialize(Archive& archive) override {
    SystemSolver::serialize(archive);
    serialize_supports(archive);
    update_balance();
    bool is_kept = balance_.has_value();
    archive(is_kept);
    if (!is_kept) return;
    if (!balance_) keep_energy_balance();
    pending_ = Pending::kNothing;
    archive(balance_->kinetic, balance_->elastic, balance_->initial, balance_->load_work, balance_->support_work,
            balance_->damping_loss, balance_->numerical_loss, balance_->recovery_work, balance_->change_work,
            balance_->flow_loss);
  }

 protected:
  SolverMemory& memory() override { return euler_->memory(); }

  // The forces of the latest step stay those of the copies that keep their numbers.
  void nodes_split(std::span<const int> split_from, int first, int end) override {
    if (support_forces_.rows() == 0) return;
    parts::insert_rows(support_forces_, split_from, first, end);
    support_forces_.middleRows(end, std::ssize(split_from)).setZero();
  }

 private:
  EulerSettings euler_settings() {
    return {.rayleigh_mass = real("rayleighMass"),
            .rayleigh_stiffness = real("rayleighStiffness"),
            .velocity_damping = real("vdamping"),
            .first_order = boolean("firstOrder"),
            .trapezoidal = boolean("trapezoidalScheme")};
  }

  void serialize_supports(Archive& archive) {
    PointArray saved = support_forces_;  // without rows where nobody keeps them
    archive(saved);
    if ((saved.rows() != 0 && saved.rows() != system().num_nodes()) || !saved.allFinite())
      throw InputError("forces of constraints are saved of other nodes");
    if (saved.rows() > 0 && !keeps_supports_) keep_support_forces();
    support_forces_ = std::move(saved);
  }

  void warn_of_growing_vibrations(const EulerSettings& settings) {
    const double dt = node().clock().dt, stable = stable_phase_per_step(settings, dt);
    if (!std::isfinite(stable)) return;
    const double frequency = system().highest_frequency();
    if (dt * frequency > stable)
      remark(
          scene::Severity::kWarning, "trapezoidalScheme",
          fmt::format("vibrations of up to {:.3g} rad/s times dt = {} s is {:.3g}: above {:.3g} they grow from step to "
                      "step, Rayleigh damping or not; take dt below {:.2g} s",
                      frequency, dt, dt * frequency, stable, stable / frequency));
  }

  /// Bodies flow at the end of a step, and return to their beginning, after this: the balance learns of it when the
  /// next step begins, or when somebody asks.
  void update_balance() {
    if (balance_ && pending_ == Pending::kBeginning) balance_->begin(kinetic_energy(), system().elastic_energy());
    if (balance_ && pending_ == Pending::kFlow) balance_->add_flow(system().elastic_energy());
    if (balance_ && pending_ == Pending::kChange) balance_->add_change(system().elastic_energy());
    pending_ = Pending::kNothing;
  }

  enum class Pending { kNothing, kBeginning, kFlow, kChange };

  bool has_inertia_ = true;
  bool keeps_supports_ = false;
  PointArray support_forces_ = PointArray(0, 3);
  std::optional<ImplicitEuler> euler_;
  std::optional<EnergyBalance> balance_;  // absent: nobody asked for it
  Pending pending_ = Pending::kNothing;   // what the balance has to learn of
  PointArray stepped_to_;                 // [m] before supports moved nodes
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
            .line_search_coefficient = real("lineSearchCoefficient")};
  }
};

class StaticSolver final : public SystemSolver {
 public:
  StaticSolver() : SystemSolver(attributes::kStaticSolver) {}

  void bwd_init() override {
    SystemSolver::bwd_init();
    SolverMemory kept = newton_ ? std::move(newton_->memory()) : SolverMemory();
    newton_settings_ = newton_settings();
    newton_.emplace(newton_settings_);
    newton_->memory() = std::move(kept);
  }

  // What is always in equilibrium has no velocity.
  SolveReport solve(double time, double dt) override {
    const NewtonReport found = system().advance([&](Points x, Points v) {
      v.setZero();
      return newton_->solve(system(), linear_solver(), time, x);
    });
    system().project_motion(time);
    const bool is_first = time < 0.5 * dt;
    if (is_first) warn_of_small_forces(found);
    return heeded(report_of(found));
  }

  SolveReport try_step(double time, double) override {
    return tried([&](Points x, Points, LinearSolver& solver) {
      NewtonSettings settings = newton_settings_;
      settings.iterations = 1;
      NewtonRaphson newton(settings);
      newton.memory().is_first = false;
      const NewtonReport found = newton.solve(system(), solver, time, x);
      warn_of_small_forces(found);
      return report_of(found);
    });
  }

 protected:
  SolverMemory& memory() override { return newton_->memory(); }

 private:
  /// Forces with which a run begins may be meant, however small.
  void warn_of_small_forces(const NewtonReport& found) {
    constexpr double kRounding = 1e-3;  // of the threshold: forces of a body at rest lie below
    if (found.status == NewtonStatus::kEquilibrium && found.residual > kRounding * newton_settings_.absolute_residual)
      remark(scene::Severity::kWarning, {},
             fmt::format("solves nothing for forces of {:.3g} N together, which lie below Newton's "
                         "absoluteResidualStoppingThreshold={:.3g}",
                         found.residual, newton_settings_.absolute_residual));
  }

  static SolveReport report_of(const NewtonReport& found) {
    const bool converged = found.status != NewtonStatus::kNotConverged;
    return {.iterations = found.linear_iterations,
            .residual = found.iterations == 0 ? 0 : found.residual / found.initial_residual,
            .converged = converged,
            .at_threshold = !converged && found.at_threshold,
            .of_newton = true,
            .preconditioner = found.preconditioner};
  }

  NewtonSettings newton_settings() {
    const bool has_solver = is_given("newtonSolver") || node().nearest<NewtonRaphsonSolver>();
    const NewtonSettings settings =
        has_solver ? linked<NewtonRaphsonSolver>("newtonSolver").settings() : NewtonRaphsonSolver().settings();
    if (!has_solver)
      remark(
          scene::Severity::kWarning, "newtonSolver",
          "no NewtonRaphsonSolver in its node or above: takes one with default settings, a single iteration per step");
    return settings;
  }

  NewtonSettings newton_settings_;
  std::optional<NewtonRaphson> newton_;
};

}  // namespace

void add_solvers(scene::Factory& factory) {
  factory.add<DefaultAnimationLoop>(attributes::kDefaultAnimationLoop);
  factory.add<CGLinearSolver>(attributes::kCGLinearSolver);
  factory.add<SparseLDLSolver>(attributes::kSparseLDLSolver);
  factory.add<MultigridCGLinearSolver>(attributes::kMultigridCGLinearSolver);
  factory.add<EulerImplicitSolver>(attributes::kEulerImplicitSolver);
  factory.add<StaticSolver>(attributes::kStaticSolver);
  factory.add<NewtonRaphsonSolver>(attributes::kNewtonRaphsonSolver);
}

}  // namespace hexaplast::components
