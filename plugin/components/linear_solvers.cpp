// SPDX-License-Identifier: LGPL-2.1-or-later
#include <optional>

#include "attributes/parts.hpp"
#include "attributes/stock.hpp"
#include "components/components.hpp"
#include "components/part.hpp"
#include "hexaplast/solve/cholesky.hpp"
#include "hexaplast/solve/conjugate_gradients.hpp"
#include "parts/multigrid_cg.hpp"
#include "scene/interfaces.hpp"

namespace hexaplast::components {
namespace {

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

}  // namespace

void add_linear_solvers(scene::Factory& factory) {
  factory.add<CGLinearSolver>(attributes::kCGLinearSolver);
  factory.add<SparseLDLSolver>(attributes::kSparseLDLSolver);
  factory.add<MultigridCGLinearSolver>(attributes::kMultigridCGLinearSolver);
}

}  // namespace hexaplast::components
