// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/system_solver.hpp"
#include "solve/explicit_integrators.hpp"
#include "solve/newmark.hpp"

namespace hexaplast::components {
namespace {

/// All of SOFA's explicit integrators.
class ExplicitSolver final : public SystemSolver {
 public:
  ExplicitSolver(const attributes::Description& description, ExplicitScheme scheme)
      : SystemSolver(description), scheme_(scheme) {}

  void bwd_init() override {
    SystemSolver::bwd_init();
    system().require_mass();
    PointArray diagonal = PointArray::Zero(system().num_nodes(), 3);
    if (!has_linear_solver() && !system().add_mass_diagonal(diagonal))
      throw InputError(find_data("linearSolver")
                           ? "masses couple nodes: needs masses with lumping, or a LinearSolver in its node or above"
                           : "masses couple nodes: needs masses with lumping");
    SolverMemory kept = integrator_ ? std::move(integrator_->memory()) : SolverMemory();
    integrator_.emplace(made());
    warn_of_growing_vibrations();
    integrator_->memory() = std::move(kept);
  }

  SolveReport solve(double time, double dt) override {
    hexaplast::LinearSolver* solver = has_linear_solver() ? &linear_solver() : nullptr;
    const SolveReport report = heeded(
        system().advance([&](Points x, Points v) { return integrator_->step(system(), solver, time, dt, x, v); }));
    system().project_motion(time);
    return report;
  }

 protected:
  SolverMemory& memory() override { return integrator_->memory(); }
  bool needs_linear_solver() override {
    return find_data("linearSolver") && (is_given("linearSolver") || node().nearest<scene::LinearSolver>());
  }

 private:
  ExplicitIntegrator made() {
    if (find_data("symplectic"))
      scheme_ = boolean("symplectic") ? ExplicitScheme::kSymplecticEuler : ExplicitScheme::kEuler;
    return ExplicitIntegrator(scheme_, find_data("rayleighMass") ? real("rayleighMass") : 0);
  }

  void warn_of_growing_vibrations() {
    const double dt = node().clock().dt, stable = stable_phase_per_step(scheme_);
    const double frequency = stable > 0 ? system().highest_frequency() : 0;
    if (dt * frequency > stable)
      remark(scene::Severity::kWarning, {},
             fmt::format("vibrations of up to {:.3g} rad/s times dt = {} s is {:.3g}: above {:.3g} they grow from step "
                         "to step; take dt below {:.2g} s",
                         frequency, dt, dt * frequency, stable, stable / frequency));
  }

  ExplicitScheme scheme_;
  std::optional<ExplicitIntegrator> integrator_;
};

class NewmarkImplicitSolver final : public SystemSolver {
 public:
  NewmarkImplicitSolver() : SystemSolver(attributes::kNewmarkImplicitSolver) {}

  void bwd_init() override {
    SystemSolver::bwd_init();
    system().require_points();
    system().require_mass();
    Newmark newmark({.rayleigh_mass = real("rayleighMass"),
                     .rayleigh_stiffness = real("rayleighStiffness"),
                     .velocity_damping = real("vdamping"),
                     .gamma = real("gamma"),
                     .beta = real("beta")});
    if (newmark_) {
      newmark.memory() = std::move(newmark_->memory());
      newmark.acceleration() = std::move(newmark_->acceleration());
    }
    newmark_.emplace(std::move(newmark));
  }

  SolveReport solve(double time, double dt) override {
    const SolveReport report = heeded(system().advance(
        [&](Points x, Points v) { return newmark_->step(system(), linear_solver(), time, dt, x, v); }));
    system().project_motion(time);
    return report;
  }

  void reset() override {
    SystemSolver::reset();
    newmark_->acceleration().resize(0, 3);
  }

  void serialize(Archive& archive) override {
    SystemSolver::serialize(archive);
    PointArray saved = newmark_->acceleration();
    archive(saved);
    if ((saved.rows() != 0 && saved.rows() != system().num_nodes()) || !saved.allFinite())
      throw InputError("accelerations are saved of other nodes");
    newmark_->acceleration() = std::move(saved);
  }

 protected:
  SolverMemory& memory() override { return newmark_->memory(); }

 private:
  std::optional<Newmark> newmark_;
};

}  // namespace

void add_integrators(scene::Factory& factory) {
  const auto add = [&](const attributes::Description& description, ExplicitScheme scheme) {
    factory.add(description, [&description, scheme] { return std::make_unique<ExplicitSolver>(description, scheme); });
  };
  add(attributes::kEulerExplicitSolver, ExplicitScheme::kSymplecticEuler);
  add(attributes::kRungeKutta2Solver, ExplicitScheme::kMidpoint);
  add(attributes::kRungeKutta4Solver, ExplicitScheme::kRungeKutta4);
  add(attributes::kCentralDifferenceSolver, ExplicitScheme::kCentralDifference);
  factory.add<NewmarkImplicitSolver>(attributes::kNewmarkImplicitSolver);
}

}  // namespace hexaplast::components
