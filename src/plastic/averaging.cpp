// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/averaging.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "hexaplast/base/parallel.hpp"

namespace hexaplast {

/// P or H of eq. 31 as a linear system.
class Averaging::System final : public LinearSystem {
 public:
  System(const Model& model, Averaging& averaging, bool projects)
      : model_(model), averaging_(averaging), projects_(projects) {
    averaging.op_.projects = projects;
  }

  int num_nodes() const override { return model_.mesh.num_nodes(); }
  bool leaves_rotation() const { return projects_; }

  void apply(ConstPoints p, Points Ap) const override {
    const Partition& partition = *model_.partition;
    const AveragingOperator& op = averaging_.op_;
    AlignedVector<double> from = slot_vector<double>(partition), to = slot_vector<double>(partition);
    to_slots(partition, p, from);
    for (int chunk = 0; chunk < partition.num_chunks; ++chunk) op.add_product(chunk, 1, from.data(), to.data());
    for (int chunk = 0; chunk < partition.num_chunks; ++chunk) reduce_ghosts(partition, chunk, to.data());
    for (int n = 0; n < num_nodes(); ++n)
      for (int i = 0; i < 3; ++i) Ap(n, i) = to[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i];
  }

  // column by column through apply's own element product; the translations of each part are pinned at its first node
  void assemble(BlockMatrix& A) const override {
    PointArray unit(num_nodes(), 3), column(num_nodes(), 3);
    for (int b = 0; b < num_nodes(); ++b)
      for (int axis = 0; axis < 3; ++axis) {
        unit.setZero();
        unit(b, axis) = 1;
        apply(unit, column);
        for (int a = 0; a < num_nodes(); ++a) {
          if (column.row(a).isZero(0)) continue;
          Mat3 block = Mat3::Zero();
          block.col(axis) = column.row(a).transpose();
          A.add(a, b, block);
        }
      }
    std::vector<bool> pinned(averaging_.parts_.count, false);
    for (int n = 0; n < num_nodes(); ++n) {
      const int part = averaging_.parts_.part_of_node[n];
      if (part >= 0 && pinned[part]) continue;
      A.add(n, n, Mat3::Identity());
      if (part >= 0) pinned[part] = true;
    }
  }

  void precondition(ConstPoints r, Points z) const override {
    parallel_for(num_nodes(), [&](int n) {
      const double weight = averaging_.node_weight_[n];
      if (weight > 0)
        z.row(n) = r.row(n) / weight;
      else
        z.row(n).setZero();
    });
  }

  bool describe(MatrixFreeSystem& system) const override {
    system.diagonal.setZero(num_nodes(), 3);
    system.free.setOnes(num_nodes(), 3);
    KernelBody& body = system.bodies.emplace_back();
    body.factor = 1;
    body.double_operator = &averaging_.op_;
    return true;
  }

  // b adds eight differences of positions at each node
  double rounding() const override { return 4 * std::numeric_limits<double>::epsilon() * averaging_.before_.norm(); }

 private:
  const Model& model_;
  const Averaging& averaging_;
  bool projects_;
};

Averaging::Averaging(const Model& model)
    : node_weight_(model.mesh.num_nodes()),
      gradient_(model.mesh.num_nodes(), 3),
      increment_(model.mesh.num_nodes(), 3),
      before_(model.mesh.num_nodes(), 3),
      op_(model.partition),
      present_(model.partition->num_blocks),
      misfit_(model.partition->num_blocks),
      size_(model.partition->num_blocks) {
  slots_.resize(*model.partition);
}

double Averaging::fit(const Model& model, History& history, bool prepares) {
  const Partition& partition = *model.partition;
  slots_.resize(partition);
  AlignedVector<double>&plastic_rest = slots_.first, &gradient = slots_.second;
  to_slots(partition, history.plastic_rest_positions, plastic_rest);
  if (prepares) std::fill(gradient.begin(), gradient.end(), 0.0);
  const FitPass pass{.partition = partition,
                     .plastic_rest = plastic_rest.data(),
                     .present = present_.data(),
                     .rest_shape = history.rest_shape.data(),
                     .rotation_map = history.rotation_map.data(),
                     .coef = prepares ? op_.coef.data() : nullptr,
                     .gradient = prepares ? gradient.data() : nullptr,
                     .misfit = misfit_.data(),
                     .size = prepares ? size_.data() : nullptr};
  parallel_for(partition.num_chunks, [&](int chunk) { fit_elements(pass, chunk); });
  if (prepares) {
    parallel_for(partition.num_chunks, [&](int chunk) { reduce_ghosts(partition, chunk, gradient.data()); });
    parallel_for(model.mesh.num_nodes(), [&](int n) {
      for (int i = 0; i < 3; ++i)
        gradient_(n, i) = gradient[4 * static_cast<std::size_t>(partition.slot_of_node[n]) + i];
    });
  }
  return std::accumulate(misfit_.begin(), misfit_.end(), 0.0);
}

const ConnectedParts& Averaging::parts(const Model& model, const History& history) {
  if (removed_ != history.removed) {
    removed_ = history.removed;
    parts_ = connected_parts(model.mesh, history.alive);
    of_part_.assign(parts_.count, Part{});
    for (int n = 0; n < model.mesh.num_nodes(); ++n) {
      node_weight_[n] = 0;
      for (const auto& [element, corner] : model.mesh.incident(n)) node_weight_[n] += history.alive[element];
      if (parts_.part_of_node[n] < 0) continue;
      Part& part = of_part_[parts_.part_of_node[n]];
      part.node = n;
      ++part.num_nodes;
    }
  }
  return parts_;
}

// Nodes in a fixed number of ranges, so that sums do not depend on threads.
template <class Add>
void Averaging::sum_over_nodes(const Add& add) {
  constexpr int kRanges = 16;
  const auto num_nodes = static_cast<Eigen::Index>(parts_.part_of_node.size());
  const std::size_t count = of_part_.size();
  partial_.resize(kRanges * count);
  parallel_for(kRanges, [&](int range) {
    Sums* const sums = partial_.data() + range * count;
    std::fill_n(sums, count, Sums{});
    for (Eigen::Index n = num_nodes * range / kRanges; n < num_nodes * (range + 1) / kRanges; ++n)
      if (const int part = parts_.part_of_node[n]; part >= 0) add(static_cast<int>(n), of_part_[part], sums[part]);
  });
  for (std::size_t part = 0; part < count; ++part) {
    Sums& all = of_part_[part].sums = {};
    for (std::size_t range = 0; range < kRanges; ++range) {
      const Sums& sums = partial_[range * count + part];
      all.field += sums.field;
      all.arms += sums.arms;
      all.spread += sums.spread;
    }
  }
}

void Averaging::remove_translation(PointArray& field) {
  sum_over_nodes([&](int n, const Part&, Sums& sums) { sums.field += field.row(n).transpose(); });
  parallel_for(static_cast<int>(field.rows()), [&](int n) {
    const int part = parts_.part_of_node[n];
    if (part < 0)
      field.row(n).setZero();
    else
      field.row(n) -= (of_part_[part].sums.field / of_part_[part].num_nodes).transpose();
  });
}

void Averaging::remove_rotation(PointArray& field, ConstPoints positions) {
  const auto arm = [&](int n, const Part& part) -> Vec3 {
    return (positions.row(n) - positions.row(part.node)).transpose();
  };
  sum_over_nodes([&](int n, const Part& part, Sums& sums) {
    const Vec3 r = arm(n, part);
    sums.arms += r;
    sums.spread += r * r.transpose();
    sums.field += r.cross(Vec3(field.row(n)));
  });
  for (Part& part : of_part_) {
    part.centre = part.sums.arms / part.num_nodes;
    const Mat3 spread = part.sums.spread - part.num_nodes * part.centre * part.centre.transpose();
    const Mat3 inertia = spread.trace() * Mat3::Identity() - spread;
    part.turn = inertia.ldlt().solve(part.sums.field);
  }
  parallel_for(static_cast<int>(field.rows()), [&](int n) {
    if (parts_.part_of_node[n] < 0) return;
    const Part& part = of_part_[parts_.part_of_node[n]];
    field.row(n) -= part.turn.cross(arm(n, part) - part.centre).transpose();
  });
}

void Averaging::step(const Model& model, LinearSolver& solver, History& history, AveragingReport& report) {
  const double E = fit(model, history, true);
  const double size = std::accumulate(size_.begin(), size_.end(), 0.0);
  if (!(E > kFitted * size)) return;
  report.skipped = false;

  remove_translation(gradient_);  // they are rounding, and outside the range of H and P
  before_ = history.plastic_rest_positions;
  const auto move = [&](bool leaves_rotation) {
    remove_translation(increment_);
    if (leaves_rotation) remove_rotation(increment_, before_);
    history.plastic_rest_positions = before_ + increment_;
    ++history.version;
  };
  const auto solve = [&](const System& system) {
    const bool warm = history.averaging_increment.size() > 0;
    if (warm) increment_ = history.averaging_increment;
    const SolveReport solved =
        warm ? solver.solve_from_guess(system, gradient_, increment_) : solver.solve(system, gradient_, increment_);
    report.iterations += solved.iterations;
    report.residual = solved.residual;
    report.converged = report.converged && solved.converged;
    move(system.leaves_rotation());
    if (warm) history.averaging_increment = increment_;
  };

  solve(System(model, *this, true));
  if (fit(model, history, false) > E) {
    // far from the fit the projected step may overshoot; the local/global step never raises E
    report.fell_back = true;
    history.plastic_rest_positions = before_;
    fit(model, history, false);  // the maps that it starts from, and keeps
    solve(System(model, *this, false));
  }
}

/// The elements of the parts that move; the others have no part in E, nor in the increment to start from.
void Averaging::choose_elements(const Model& model, History& history, std::span<const unsigned char> changed) {
  const auto part_of = [&](int e) { return parts_.part_of_node[model.mesh.hexahedra()[e][0]]; };
  part_moves_.assign(parts_.count, changed.empty());
  for (std::size_t e = 0; e < changed.size(); ++e)
    if (changed[e] && history.alive[e]) part_moves_[part_of(static_cast<int>(e))] = 1;
  chosen_ = history.alive;
  if (std::find(part_moves_.begin(), part_moves_.end(), 0) != part_moves_.end()) {
    for (int e = 0; e < model.mesh.num_elements(); ++e)
      if (chosen_[e]) chosen_[e] = part_moves_[part_of(e)];
    for (int n = 0; n < history.averaging_increment.rows(); ++n)
      if (parts_.part_of_node[n] < 0 || !part_moves_[parts_.part_of_node[n]])
        history.averaging_increment.row(n).setZero();
  }
  const Partition& partition = *model.partition;
  for (int block = 0; block < partition.num_blocks; ++block) {
    double* weight = op_.weights_of(block);
    present_[block] = 0;
    for (int place = 0; place < kBlock; ++place) {
      const int e = partition.element(block, place);
      const bool counts = e >= 0 && chosen_[e];
      weight[place] = counts ? 1 : 0;
      if (counts) present_[block] |= static_cast<std::uint16_t>(1u << place);
    }
  }
}

AveragingReport Averaging::advance(const Model& model, LinearSolver& solver, History& history,
                                   std::span<const unsigned char> changed) {
  parts(model, history);
  choose_elements(model, history, changed);
  AveragingReport report;
  for (int step_number = 0; step_number < model.settings.averaging_steps; ++step_number)
    step(model, solver, history, report);
  return report;
}

}  // namespace hexaplast
