// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/solve/cholesky.hpp"

#include <cholmod.h>
#include <fmt/format.h>

#include "hexaplast/base/error.hpp"
#include "solve/cg_loop.hpp"

namespace hexaplast {

namespace {

constexpr double kRestOfLoad = 1e-12;       // of |b|, left by conjugate gradients
constexpr int kMaxIterationsOfRest = 1000;  // about six for each cluster of more than 200 nodes

}  // namespace

struct CholeskySolver::Factor final : NodalPreconditioner {
  cholmod_common common{};
  cholmod_sparse* lower = nullptr;  // lower triangle, compressed columns, 3 per node
  cholmod_factor* factor = nullptr;
  cholmod_dense* right_hand_side = nullptr;
  cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;  // kept by cholmod_l_solve2 between calls
  long pattern_version = -1;
  NodalCgSpace space;

  Factor() {
    cholmod_l_start(&common);
    common.print = 0;     // errors come back as a status
    common.final_ll = 1;  // L L^T: an indefinite matrix is found, where L D L^T would pass
#ifdef HEXAPLAST_WITH_SUPERNODAL
    common.supernodal = CHOLMOD_AUTO;
#else
    common.supernodal = CHOLMOD_SIMPLICIAL;
#endif
  }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;
  ~Factor() override {
    free_all();
    cholmod_l_finish(&common);
  }

  void free_all() {
    cholmod_l_free_sparse(&lower, &common);
    cholmod_l_free_factor(&factor, &common);
    for (cholmod_dense** dense : {&right_hand_side, &solution, &work_y, &work_e}) cholmod_l_free_dense(dense, &common);
    pattern_version = -1;
  }

  /// The lower triangle's pattern and its fill-reducing order.
  void analyse(const BlockMatrix& A) {
    free_all();
    const std::size_t size = 3 * static_cast<std::size_t>(A.num_nodes());
    std::size_t entries = 0;
    for (int n = 0; n < A.num_nodes(); ++n)
      for (const auto& entry : A.row(n)) entries += entry.column > n ? 9 : entry.column == n ? 6 : 0;

    lower = cholmod_l_allocate_sparse(size, size, entries, 1, 1, -1, CHOLMOD_REAL, &common);
    right_hand_side = cholmod_l_allocate_dense(size, 1, size, CHOLMOD_REAL, &common);
    if (!lower || !right_hand_side)
      throw NumericalError(fmt::format("Cholesky: not enough memory for {} unknowns", size));
    fill(A);
    factor = cholmod_l_analyze(lower, &common);
    if (!factor)
      throw NumericalError(fmt::format("Cholesky: analysis of {} unknowns failed ({})", size, common.status));
    pattern_version = A.pattern_version();
  }

  /// The blocks right of the diagonal, read along a row, are the lower triangle's entries down a column.
  void fill(const BlockMatrix& A) {
    auto* first = static_cast<SuiteSparse_long*>(lower->p);
    auto* rows = static_cast<SuiteSparse_long*>(lower->i);
    auto* values = static_cast<double*>(lower->x);
    SuiteSparse_long at = 0;
    for (int n = 0; n < A.num_nodes(); ++n) {
      for (int j = 0; j < 3; ++j) {
        first[3 * n + j] = at;
        for (const auto& entry : A.row(n)) {
          if (entry.column < n) continue;
          for (int i = entry.column == n ? j : 0; i < 3; ++i, ++at) {
            rows[at] = 3 * SuiteSparse_long{entry.column} + i;
            values[at] = entry.block(j, i);
          }
        }
      }
    }
    first[3 * A.num_nodes()] = at;
  }

  /// z = A^-1 r of the factorised A.
  void solve(ConstPoints r, Points z) {
    Eigen::Map<PointArray>(static_cast<double*>(right_hand_side->x), r.rows(), 3) = r;
    if (!cholmod_l_solve2(CHOLMOD_A, factor, right_hand_side, nullptr, &solution, nullptr, &work_y, &work_e, &common))
      throw NumericalError(fmt::format("Cholesky: the solution failed ({})", common.status));
    z = Eigen::Map<const PointArray>(static_cast<const double*>(solution->x), r.rows(), 3);
  }
  void apply(const PointArray& r, PointArray& z) override { solve(r, z); }
};

CholeskySolver::CholeskySolver() : factor_(std::make_unique<Factor>()) {}
CholeskySolver::~CholeskySolver() = default;

// The order of elimination, and with it the last bits, comes from the pattern: it is that of the present system alone.
void CholeskySolver::factorise(const LinearSystem& A) {
  if (matrix_.num_nodes() != A.num_nodes()) {
    matrix_ = BlockMatrix(A.num_nodes());
    factor_->pattern_version = -1;
  }
  matrix_.clear();
  A.assemble(matrix_);
  matrix_.drop_unused();

  Factor& f = *factor_;
  if (f.pattern_version != matrix_.pattern_version())
    f.analyse(matrix_);
  else
    f.fill(matrix_);
  cholmod_l_factorize(f.lower, f.factor, &f.common);
  const auto status = f.common.status;
  const bool is_definite = status >= CHOLMOD_OK && status != CHOLMOD_NOT_POSDEF;
  const bool is_finite = is_definite && cholmod_l_rcond(f.factor, &f.common) > 0;  // no pivot stands out of all numbers
  if (is_finite) return;

  const auto minor = f.factor->minor;  // in the order of elimination
  const auto pivot = minor < f.factor->n ? static_cast<const SuiteSparse_long*>(f.factor->Perm)[minor] : 0;
  f.free_all();  // what it has become is no beginning for another
  if (is_definite) throw NumericalError("Cholesky: the matrix is not finite");
  if (status == CHOLMOD_NOT_POSDEF)
    throw NumericalError(
        fmt::format("Cholesky: the matrix is not positive definite (node {} of {} has no positive "
                    "pivot along {})",
                    pivot / 3, matrix_.num_nodes(), "xyz"[pivot % 3]));
  throw NumericalError(fmt::format("Cholesky: factorisation failed ({})", status));
}

SolveReport CholeskySolver::solve(const LinearSystem& A, ConstPoints b, Points x) {
  require_sizes(A, b, x);
  factorise(A);
  Factor& f = *factor_;
  if (!b.allFinite()) throw NumericalError("Cholesky: the right-hand side is not finite");
  SolveReport report{.iterations = 1, .residual = 0, .converged = true};
  report.preconditioner = PreconditionedBy::kFactorisation;
  if (!matrix_.leaves_out()) {
    f.solve(b, x);
    return report;
  }
  const double norm_b = std::sqrt(finite_square(b));
  int iterations = 0;
  f.space.setup(A, true, nullptr, &f);
  const double r_r = iterate(
      f.space, f.space.begin(b, nullptr), kMaxIterationsOfRest, iterations,
      [&](double square) { return std::sqrt(square) <= kRestOfLoad * norm_b; },
      [](double, double p_Ap) {
        if (!(p_Ap > 0)) throw_indefinite(p_Ap);
        return true;
      });
  f.space.end(x);
  if (norm_b > 0) report.residual = std::sqrt(r_r) / norm_b;
  report.converged = report.residual <= kRestOfLoad;
  return report;
}

}  // namespace hexaplast
