// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "components/mechanical_system.hpp"
#include "hexaplast/base/error.hpp"
#include "parts/spread_nodes.hpp"

namespace hexaplast::components {

/// Moves everything of its node and below, by linear systems of a LinearSolver.
class SystemSolver : public scene::OdeSolver, public scene::Stateful, public scene::FollowsNodes {
 public:
  using OdeSolver::OdeSolver;

  // The linear solver and what there is to move may stand anywhere in the node: they are complete when init is done.
  void bwd_init() override {
    linear_solver_ = &linked<scene::LinearSolver>("linearSolver");
    for (scene::Component* component : node().all<scene::Component>())
      if (component->stage() == Stage::kFailed) throw scene::DependencyFailure();
    const bool begins = !system_;  // it comes again where something is added: Scene::add
    system_.emplace(node());
    if (linear_solver_->needs_matrix())
      system_->require_matrix(fmt::format("{} '{}'", linear_solver_->class_name(), linear_solver_->name()));
    if (!begins) return;
    system_->project_motion(0);
    system_->warn_of_sizes();
  }

  /// Told by constraints of what it moves that hold other nodes from now on.
  void constraints_changed() {
    if (system_) system_->constraints_changed();
  }

  void nodes_changed(scene::MechanicalState& state, std::span<const int> split_from) override {
    if (!system_) return;
    const int first = system_->first_node_of(state),
              end = first + state.num_nodes() - static_cast<int>(split_from.size());
    const int num_before = system_->num_nodes();
    system_.emplace(node());
    if (split_from.empty()) return memory().reset();  // what begins anew, or is read
    if (first < 0) return;
    if (memory().start.rows() == num_before) parts::insert_rows(memory().start, split_from, first, end);
    memory().radii.clear();  // those of another matrix, whatever it has in common with the next
    nodes_split(split_from, first, end);
  }

  void reset() override {
    memory().reset();
    system_->project_motion(0);
  }

  void serialize(Archive& archive) override {
    SolverMemory saved = memory();
    saved.serialize(archive);
    const bool is_ours = saved.start.rows() == 0 || saved.start.rows() == system_->num_nodes();
    if (!is_ours || !saved.start.allFinite()) throw InputError("the start of a solve is saved of other nodes");
    if (!saved.is_valid()) throw InputError("the spectral radii of a solver are saved as what they cannot be");
    memory() = std::move(saved);
  }

  double kinetic_energy() const override { return system_->kinetic_energy(); }

 protected:
  virtual SolverMemory& memory() = 0;  ///< of its integrator

  /// Nodes have come after those of a state, whose rows go from first to end.
  virtual void nodes_split(std::span<const int> /*split_from*/, int /*first*/, int /*end*/) {}

  hexaplast::LinearSolver& linear_solver() { return linear_solver_->method(); }

  /// What the linear solver did, to be passed on.
  const SolveReport& heeded(const SolveReport& report) {
    linear_solver_->heed(report);
    return report;
  }
  NodeSystem& system() { return *system_; }

  /// What solve(x, v, solver) reports of copies of the positions and velocities.
  template <class Solve>
  SolveReport tried(const Solve& solve) {
    PointArray x = system_->positions(), v = system_->velocities();
    try {
      return solve(x, v, linear_solver());
    } catch (const NumericalError& error) {
      linear_solver_->reject(fmt::format("cannot solve a step: {}", error.what()));
    }
  }

 private:
  scene::LinearSolver* linear_solver_ = nullptr;
  std::optional<NodeSystem> system_;
};

}  // namespace hexaplast::components
