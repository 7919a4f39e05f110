// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/preconditioners.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

void MatrixPartSolver::setup(const LinearSystem& A) {
  const int num_nodes = A.num_nodes();
  if (matrix_.num_nodes() != num_nodes) matrix_ = BlockMatrix(num_nodes);
  matrix_.clear();
  A.assemble(matrix_);
  inverse_.resize(num_nodes);
  for (int n = 0; n < num_nodes; ++n) {
    const auto& row = matrix_.row(n);
    const auto entry = std::ranges::find(row, n, &BlockMatrix::Entry::column);
    Mat3 block = entry == row.end() ? Mat3(Mat3::Zero()) : entry->block;
    if (part_ != MatrixPart::kDiagonalBlocks) block = Mat3(block.diagonal().asDiagonal());
    if (!(block.diagonal().minCoeff() > 0))
      throw NumericalError(fmt::format("preconditioner: the diagonal of node {} is not positive", n));
    inverse_[n] = block.inverse();
  }
}

SolveReport MatrixPartSolver::solve_again(const LinearSystem& A, ConstPoints b, Points x) {
  require_sizes(A, b, x);
  if (static_cast<int>(inverse_.size()) != A.num_nodes())
    throw InputError("preconditioner: setup must come before solve_again");
  if (part_ == MatrixPart::kSymmetricSweep)
    sweep(b, x);
  else
    parallel_for(A.num_nodes(), [&](int n) { x.row(n) = b.row(n) * inverse_[n]; });  // symmetric
  return {.iterations = 1, .converged = false, .preconditioner = PreconditionedBy::kDiagonal};
}

SolveReport MatrixPartSolver::solve(const LinearSystem& A, ConstPoints b, Points x) {
  require_sizes(A, b, x);
  setup(A);
  return solve_again(A, b, x);
}

/// Row by row, up and then down: each takes the rows that are there already.
void MatrixPartSolver::sweep(ConstPoints b, Points x) const {
  const int num_nodes = matrix_.num_nodes();
  const auto sum = [&](int n, int i, auto is_there) {
    double total = 0;
    for (const BlockMatrix::Entry& entry : matrix_.row(n))
      for (int j = 0; j < 3; ++j)
        if (is_there(3 * entry.column + j, 3 * n + i)) total += entry.block(i, j) * x(entry.column, j);
    return total;
  };
  for (int n = num_nodes - 1; n >= 0; --n)
    for (int i = 2; i >= 0; --i)
      x(n, i) = (b(n, i) - sum(n, i, [](int k, int of) { return k > of; })) * omega_ * inverse_[n](i, i);
  for (int n = 0; n < num_nodes; ++n)
    for (int i = 0; i < 3; ++i) x(n, i) -= sum(n, i, [](int k, int of) { return k < of; }) * omega_ * inverse_[n](i, i);
  x *= 2 - omega_;
}

}  // namespace hexaplast
