// SPDX-License-Identifier: LGPL-2.1-or-later
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "attributes/parts.hpp"
#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "parts/multigrid_cg.hpp"
#include "scene/interfaces.hpp"
#include "solve/minres.hpp"
#include "solve/preconditioners.hpp"

namespace hexaplast::components {
namespace {

/// Where SOFA assembles a matrix.
class MatrixLinearSystem final : public scene::Component {
 public:
  static constexpr std::string_view kCategory = "LinearSystem";
  using Component::Component;

  bool is_whole() {
    for (const char* part : {"assembleStiffness", "assembleMass", "assembleDamping", "applyProjectiveConstraints",
                             "applyMappedComponents"})
      if (!boolean(part)) return false;
    return true;
  }
};

/// A solver that may be linked to a linear system of SOFA's.
class LinkedSolver : public scene::LinearSolver {
 public:
  using LinearSolver::LinearSolver;

  void init() override {
    auto* linked_system = dynamic_cast<MatrixLinearSystem*>(find_data("linearSystem")->target());
    if (linked_system && !linked_system->is_whole())
      reject("linearSystem", fmt::format("the link leads to {} '{}', which leaves out a part of the matrix",
                                         linked_system->class_name(), linked_system->name()));
  }
};

/// What a PCGLinearSolver may take as preconditioner.
class Preconditioning : public LinkedSolver {
 public:
  using LinkedSolver::LinkedSolver;
  virtual hexaplast::LinearSolver& preconditioner() = 0;
  virtual PreconditionedBy kind() { return PreconditionedBy::kFactorisation; }
};

class DirectSolver final : public Preconditioning {
 public:
  using Preconditioning::Preconditioning;
  hexaplast::LinearSolver& method() override { return solver_; }
  bool needs_matrix() override { return true; }
  hexaplast::LinearSolver& preconditioner() override { return solver_; }

 private:
  CholeskySolver solver_;
};

/// Solves nothing by itself.
class Preconditioner : public Preconditioning {
 public:
  using Preconditioning::Preconditioning;
  hexaplast::LinearSolver& method() override {
    reject("is a preconditioner, must be linked to by a PCGLinearSolver, behind which it stands in the node");
  }
};

class MatrixPartPreconditioner final : public Preconditioner {
 public:
  MatrixPartPreconditioner(const attributes::Description& description, MatrixPart part)
      : Preconditioner(description), part_(part) {}

  void init() override {
    Preconditioner::init();
    solver_.emplace(part_, part_ == MatrixPart::kSymmetricSweep ? real("omega") : 1);
  }
  hexaplast::LinearSolver& preconditioner() override { return *solver_; }
  PreconditionedBy kind() override { return PreconditionedBy::kDiagonal; }

 private:
  MatrixPart part_;
  std::optional<MatrixPartSolver> solver_;
};

/// What it stands for.
class WarpPreconditioner final : public Preconditioner {
 public:
  using Preconditioner::Preconditioner;

  hexaplast::LinearSolver& preconditioner() override { return stands_for() ? stands_for()->preconditioner() : exact_; }
  PreconditionedBy kind() override { return stands_for() ? stands_for()->kind() : PreconditionedBy::kFactorisation; }

 private:
  Preconditioning* stands_for() {
    if (!is_given("linearSolver")) return nullptr;
    auto& solver = linked<scene::LinearSolver>("linearSolver");
    auto* found = dynamic_cast<Preconditioning*>(&solver);
    if (!found || dynamic_cast<WarpPreconditioner*>(found))
      reject("linearSolver", fmt::format("the link leads to {} '{}', must lead to a direct solver or a preconditioner",
                                         solver.class_name(), solver.name()));
    return found;
  }

  CholeskySolver exact_;
};

class CGLinearSolver final : public LinkedSolver {
 public:
  using LinkedSolver::LinkedSolver;

  void init() override {
    LinkedSolver::init();
    solver_.emplace(ConjugateGradientSettings{.iterations = integer("iterations"),
                                              .tolerance = real("tolerance"),
                                              .threshold = real("threshold"),
                                              .warm_start = boolean("warmStart")});
  }
  hexaplast::LinearSolver& method() override { return *solver_; }

 private:
  std::optional<ConjugateGradients> solver_;
};

class MinResLinearSolver final : public LinkedSolver {
 public:
  MinResLinearSolver() : LinkedSolver(attributes::kMinResLinearSolver) {}

  void init() override {
    LinkedSolver::init();
    solver_.emplace(real("tolerance"), integer("iterations"));
  }
  hexaplast::LinearSolver& method() override { return *solver_; }

 private:
  std::optional<MinimumResiduals> solver_;
};

class PCGLinearSolver final : public LinkedSolver {
 public:
  PCGLinearSolver() : LinkedSolver(attributes::kPCGLinearSolver) {}

  // Made when it is first asked for, so that the components of a node may stand in any order.
  hexaplast::LinearSolver& method() override {
    if (solver_) return *solver_;
    hexaplast::LinearSolver* preconditioner = nullptr;
    PreconditionedBy kind = PreconditionedBy::kNothing;
    if (is_given("preconditioner") && boolean("use_precond")) {
      auto& linked_solver = linked<scene::LinearSolver>("preconditioner");
      auto* found = dynamic_cast<Preconditioning*>(&linked_solver);
      if (!found)
        reject("preconditioner",
               fmt::format("the link leads to {} '{}', must lead to a direct solver or a preconditioner",
                           linked_solver.class_name(), linked_solver.name()));
      preconditioner = &found->preconditioner();
      kind = found->kind();
    }
    return solver_.emplace(real("tolerance"), integer("iterations"), preconditioner, kind);
  }
  bool needs_matrix() override { return is_given("preconditioner") && boolean("use_precond"); }

 private:
  std::optional<SolverPreconditionedConjugateGradients> solver_;
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

}  // namespace

void add_linear_solvers(scene::Factory& factory) {
  for (const attributes::Description* description :
       {&attributes::kCGLinearSolver, &attributes::kParallelCGLinearSolver})
    factory.add(*description, [description] { return std::make_unique<CGLinearSolver>(*description); });
  factory.add<PCGLinearSolver>(attributes::kPCGLinearSolver);
  factory.add<MinResLinearSolver>(attributes::kMinResLinearSolver);
  factory.add<MultigridCGLinearSolver>(attributes::kMultigridCGLinearSolver);
  for (const attributes::Description& description : attributes::kDirectSolvers)
    factory.add(description, [&description] { return std::make_unique<DirectSolver>(description); });
  const auto add_part = [&](const attributes::Description& description, MatrixPart part) {
    factory.add(description,
                [&description, part] { return std::make_unique<MatrixPartPreconditioner>(description, part); });
  };
  add_part(attributes::kJacobiPreconditioner, MatrixPart::kDiagonal);
  add_part(attributes::kBlockJacobiPreconditioner, MatrixPart::kDiagonalBlocks);
  add_part(attributes::kSSORPreconditioner, MatrixPart::kSymmetricSweep);
  for (const attributes::Description& description : attributes::kWarpPreconditioners)
    factory.add(description, [&description] { return std::make_unique<WarpPreconditioner>(description); });
  for (const attributes::Description& description : attributes::kMatrixLinearSystems)
    factory.add(description, [&description] { return std::make_unique<MatrixLinearSystem>(description); });
}

}  // namespace hexaplast::components
