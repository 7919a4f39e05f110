// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve/several_bodies.hpp"

#include <algorithm>
#include <tuple>

#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

/// to += W B W from
void SeveralBodies::Part::add_cycle(ConstPoints from, Points to) {
  if (device) {
    weighted = weight.asDiagonal() * from;
    preconditioned.setZero(weighted.rows(), 3);
    device->add_preconditioned(weighted, preconditioned);
    to += weight.asDiagonal() * preconditioned;
    return;
  }
  r.resize(4 * static_cast<std::size_t>(partition->num_slots), 0.0f);
  z.resize(r.size(), 0.0f);
  const double scale = scale_to_one(from.cwiseAbs().maxCoeff());  // cycles are in single precision
  parallel_for(partition->num_nodes, [&](int n) {
    float* slot = r.data() + 4 * static_cast<std::size_t>(partition->slot_of_node[n]);
    for (int i = 0; i < 3; ++i) slot[i] = static_cast<float>(scale * weight[n] * from(n, i));
  });
  multigrid.apply(r, z);
  parallel_for(partition->num_nodes, [&](int n) {
    const float* slot = z.data() + 4 * static_cast<std::size_t>(partition->slot_of_node[n]);
    for (int i = 0; i < 3; ++i) to(n, i) += weight[n] / scale * static_cast<double>(slot[i]);
  });
}

void SeveralBodies::find_stiffness(const KernelBody& body, Part& part) {
  const auto find = [&]<class T>(const ChunkedOperator<T>& op, AlignedVector<T>& slots) {
    const Partition& partition = op.partition();
    part.partition = &partition;
    slots.resize(4 * static_cast<std::size_t>(partition.num_slots));
    find_diagonal(op, static_cast<T>(body.factor), slots);
    part.stiffness.resize(partition.num_nodes, 3);
    for (int n = 0; n < partition.num_nodes; ++n)
      for (int i = 0; i < 3; ++i)
        part.stiffness(n, i) = static_cast<double>(slots[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i]);
  };
  part.first_node = body.first_node;
  part.device = device_of(body);
  if (part.device) {
    part.stiffness.setZero(part.device->num_nodes(), 3);
    part.device->find_diagonal(body.factor, part.stiffness);
  } else if (body.single_operator) {
    find(*body.single_operator, part.r);
  } else {
    find(*body.double_operator, slots_);
  }
}

bool SeveralBodies::has_coarse_meshes(const KernelBody& body) {
  return device_of(body) ? device_of(body)->has_coarse_meshes() : !body.levels.empty();
}

const std::vector<NodeGroup>& SeveralBodies::find_groups(const MatrixFreeSystem& system) {
  num_parts_ = system.bodies.size();
  if (parts_.size() < num_parts_) parts_.resize(num_parts_);
  candidates_.clear();
  for (std::size_t i = 0; i < num_parts_; ++i) {
    const Part& part = parts_[i];
    find_stiffness(system.bodies[i], parts_[i]);
    const NodeGroup group{part.first_node, static_cast<int>(part.stiffness.rows())};
    const auto same = [&](const Candidate& other) { return other.group.first_node == group.first_node; };
    if (std::ranges::any_of(candidates_, same)) continue;
    candidates_.push_back(Candidate{group, group.rows(system.constraints.free).minCoeff() == 0, part.stiffness.mean()});
  }
  std::ranges::sort(candidates_, {}, [](const Candidate& candidate) {
    return std::tuple(candidate.is_held, candidate.stiffness, candidate.group.first_node);
  });
  groups_.clear();
  // nodes of no body first: they are the softest
  is_of_body_.assign(static_cast<std::size_t>(system.diagonal.rows()), false);
  for (const Candidate& candidate : candidates_)
    std::fill_n(is_of_body_.begin() + candidate.group.first_node, candidate.group.num_nodes, true);
  for (int n = 0; n < static_cast<int>(is_of_body_.size()); ++n) {
    if (is_of_body_[n]) continue;
    if (!groups_.empty() && groups_.back().first_node + groups_.back().num_nodes == n)
      ++groups_.back().num_nodes;
    else
      groups_.push_back({n, 1});
  }
  for (const Candidate& candidate : candidates_) groups_.push_back(candidate.group);
  return groups_;
}

bool SeveralBodies::setup(const MatrixFreeSystem& system, const NodalPart& rest, const LumpedTerms* lumped, bool cycles,
                          std::span<SpectralRadii> radii) {
  bool are_known = false;
  system_ = &system;
  ties_.clear();
  for (std::size_t g = 0; lumped && g < groups_.size(); ++g) ties_.push_back(lumped->ties(g));
  if (std::ranges::none_of(ties_, [](bool is_tied) { return is_tied; })) ties_.clear();
  inverse_ = rest.diagonal;
  sum_.setZero(rest.diagonal.rows());
  for (std::size_t i = 0; i < num_parts_; ++i) {
    parts_[i].rows(inverse_) += parts_[i].stiffness;
    parts_[i].rows(sum_) += parts_[i].stiffness.rowwise().sum();
  }
  weight_of_rest_.resize(sum_.size());
  for (Eigen::Index n = 0; n < sum_.size(); ++n) weight_of_rest_[n] = sum_[n] > 0 ? 0 : 1;

  for (std::size_t i = 0; i < num_parts_; ++i) {
    Part& part = parts_[i];
    const KernelBody& body = system.bodies[i];
    part.weight = part.stiffness.rowwise().sum();
    const auto num_nodes = static_cast<int>(part.weight.size());
    for (int n = 0; n < num_nodes; ++n) {
      const double sum = sum_[part.first_node + n];
      part.weight[n] = sum > 0 ? part.weight[n] / sum : 0;
    }
    part.cycles = cycles && has_coarse_meshes(body);
    if (!part.cycles) {
      part.rows(weight_of_rest_) += part.weight;
      continue;
    }
    part.diagonal = part.weight.asDiagonal() * part.rows(rest.diagonal);
    part.own_diagonal = part.weight.asDiagonal() * part.rows(system.diagonal);
    part.free = part.rows(rest.free);
    for (int n = 0; n < num_nodes; ++n)
      if (part.weight[n] == 0) part.free.row(n).setZero();
    part.blocks.clear();
    for (const auto& [node, block] : rest.blocks) {
      const int own = node - part.first_node;
      if (own >= 0 && own < num_nodes && part.weight[own] > 0) part.blocks.push_back({own, part.weight[own] * block});
    }
    const NodalPart own{
        .diagonal = part.diagonal, .free = part.free, .blocks = part.blocks, .own_diagonal = &part.own_diagonal};
    if (!part.device) {
      are_known |= part.multigrid.setup(body, own, radii[i]);
      continue;
    }
    part.of_device.bodies = {body};
    part.of_device.diagonal = part.own_diagonal;
    part.of_device.constraints.free = part.free;
    part.device->space(part.of_device, &own);
    are_known |= part.device->use_cycles(true, radii[i]).value_or(false);
  }

  blocks_.clear();
  for (const auto& [node, block] : rest.blocks) {
    const BlockAxes along(inverse_.row(node).transpose(), block);
    blocks_.push_back({node, along.axes * along.compliance().asDiagonal() * along.axes.transpose()});
    for (int i = 0; i < 3; ++i)
      if (along.is_coupled[i]) inverse_(node, i) = 0;
  }
  for (double& entry : inverse_.reshaped()) entry = entry > 0 ? 1 / entry : 0;
  return are_known;
}

void SeveralBodies::apply(const PointArray& r, PointArray& z) {
  if (ties_.empty()) {
    apply_to({0, static_cast<int>(r.rows())}, r, z);
  } else {
    z.setZero(r.rows(), 3);
    bool is_tied = false;  // to one before it, maybe
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      left_ = r;
      if (is_tied) subtract_ties(z, left_);
      apply_to(groups_[g], left_, z);
      is_tied = is_tied || ties_[g];
    }
    for (std::size_t g = groups_.size() - 1; g-- > 0;) {
      if (!ties_[g]) continue;
      later_.setZero(r.rows(), 3);
      for (std::size_t k = g + 1; k < groups_.size(); ++k) groups_[k].rows(later_) = groups_[k].rows(z);
      left_.setZero(r.rows(), 3);
      subtract_ties(later_, left_);
      product_.resize(r.rows(), 3);
      apply_to(groups_[g], left_, product_);
      groups_[g].rows(z) += groups_[g].rows(product_);
    }
  }
  if (system_->constraints.projector) system_->constraints.project(z);
}

/// r -= F z, of the terms beside the bodies.
void SeveralBodies::subtract_ties(const PointArray& z, PointArray& r) {
  product_.setZero(r.rows(), 3);
  for (const NodalTerm& other : system_->others) other.add_product(z, product_);
  r -= product_.cwiseProduct(system_->constraints.free.cast<double>());
}

/// z = B r in the rows of a group.
void SeveralBodies::apply_to(const NodeGroup& group, const PointArray& r, PointArray& z) {
  group.rows(z) =
      group.rows(weight_of_rest_).cwiseAbs2().asDiagonal() * group.rows(inverse_).cwiseProduct(group.rows(r));
  const auto is_in = [&](int node) { return node >= group.first_node && node < group.first_node + group.num_nodes; };
  for (const auto& [node, inverse] : blocks_)
    if (is_in(node)) z.row(node) += weight_of_rest_[node] * weight_of_rest_[node] * r.row(node) * inverse;  // symmetric
  for (std::size_t i = 0; i < num_parts_; ++i) {
    Part& part = parts_[i];
    if (part.cycles && is_in(part.first_node)) part.add_cycle(part.rows(r), part.rows(z));
  }
}

}  // namespace hexaplast
