// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parts/multigrid_cg.hpp"

#include <fmt/format.h>

#include "attributes/parts.hpp"

namespace hexaplast::parts {
namespace {

const MultigridCGOptions& checked(const MultigridCGOptions& options) {
  OptionRanges(attributes::kMultigridCGLinearSolver, options).throw_all();
  return options;
}

}  // namespace

MultigridCG::MultigridCG(const MultigridCGOptions& options)
    : options_(checked(options)), solver_(options.tolerance, options.iterations, options.preconditioner) {}

std::vector<Remark> MultigridCG::heed(const SolveReport& report) {
  if (report.preconditioner == PreconditionedBy::kMultigrid) has_cycled_ = true;
  if (is_warned_ || options_.preconditioner != Preconditioner::kMultigrid || report.iterations == 0 ||
      report.preconditioner == PreconditionedBy::kMultigrid)
    return {};
  is_warned_ = true;
  if (has_cycled_)
    return {{"preconditioner",
             fmt::format("is multigrid, which is not positive definite in a step: the preconditioner is {} there",
                         name_of(report.preconditioner))}};
  return {{"preconditioner",
           fmt::format("is multigrid, which needs a body whose hexahedra form a lattice of more than a few, computed "
                       "by the kernels and in shapes of which its cycle is positive definite: the preconditioner is {} "
                       "instead",
                       name_of(report.preconditioner))}};
}

}  // namespace hexaplast::parts
