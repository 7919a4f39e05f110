// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/body_residuals.hpp"

#include <algorithm>
#include <cmath>

#include "hexaplast/base/parallel.hpp"
#include "solve/constants.hpp"

namespace hexaplast {

void BodyResiduals::setup(const MatrixFreeSystem& system, ConstPoints b) {
  system_ = &system;
  parts_.clear();
  if (system.parts.size() < 2) return;
  for (const NodeGroup& nodes : system.parts) parts_.push_back({nodes, parts_.size()});
  const auto body_of = [&](int node) {
    return std::ranges::find_if(parts_,
                                [&](const Part& part) { return node < part.nodes.first_node + part.nodes.num_nodes; })
        ->body;
  };
  for (const auto& [first, second] : system.constraints.ties) {
    const auto [kept, joined] = std::minmax({body_of(first), body_of(second)});
    for (Part& part : parts_)
      if (part.body == joined) part.body = kept;
  }
  if (std::ranges::all_of(parts_, [](const Part& part) { return part.body == 0; })) return parts_.clear();

  norm_b_ = std::sqrt(dot(b, b));
  const bool is_single =
      std::ranges::any_of(system.bodies, [](const KernelBody& body) { return !body.double_operator; });
  nothing_ = (is_single ? kNothingInSingle : kNothingInDouble) * norm_b_;
  norms_.assign(parts_.size(), {});
  for (const Part& part : parts_) {
    const ConstPoints rows(part.nodes.rows(b));
    norms_[part.body].load = std::hypot(norms_[part.body].load, std::sqrt(dot(rows, rows)));
  }
}

double BodyResiduals::size(ConstPoints r, ConstPoints x, double unit) {
  if (parts_.empty()) return 0;
  for (Norms& norms : norms_) norms.transmitted = norms.residual = 0;
  product_.setZero(x.rows(), 3);
  for (const NodalTerm& other : system_->others) other.add_product(x, product_);
  product_ = product_.cwiseProduct(system_->constraints.free.cast<double>());
  for (const Part& part : parts_) {
    Norms& norms = norms_[part.body];
    const ConstPoints product(part.nodes.rows(product_)), rows(part.nodes.rows(r));
    norms.transmitted = std::hypot(norms.transmitted, unit * std::sqrt(dot(product, product)));
    norms.residual = std::hypot(norms.residual, unit * std::sqrt(dot(rows, rows)));
  }
  double largest = 0;
  for (const Norms& norms : norms_) {
    const double acting = std::max({norms.load, norms.corrected, norms.transmitted});
    if (norms.residual > nothing_) largest = std::max(largest, norms.residual / (acting > 0 ? acting : norm_b_));
  }
  return norm_b_ * largest;
}

double BodyResiduals::size_at(ConstPoints r, ConstPoints x) {
  for (Norms& norms : norms_) norms.corrected = 0;
  const double found = size(r, x, 1);
  for (Norms& norms : norms_) norms.corrected = norms.transmitted;
  return found;
}

}  // namespace hexaplast
