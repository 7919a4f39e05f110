// SPDX-License-Identifier: LGPL-2.1-or-later
#define HEXAPLAST_ONE_NUMBER
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/require.hpp"
#include "hexaplast/base/error.hpp"
#include "kinematics/polar.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"
#include "plastic/fracture.hpp"
#include "plastic/isolated_flow.hpp"
#include "plastic/point_flow-inl.hpp"

namespace hexaplast::plain {

namespace scalar = HWY_NAMESPACE;  // the formulas, here of doubles

namespace {

constexpr double kCollapsedJacobian = 0.02;  // of the original: averaging may not press a corner below

/// Smallest det J_i(x) / det J_i(X) of an element's corners.
double min_jacobian_ratio(const CornerValues& initial, const ElementPoints& x) {
  double min = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kCorners; ++i) min = std::min(min, corner_jacobian(x, i).determinant() / initial[i]);
  return min;
}

/// B of the paper's rotation modes: per connected part, the rotation that fits the plastic rest positions best to the
/// current ones.                                                                                        theory.md 5.6
std::vector<Mat3> fit_frames(const ConnectedParts& parts, ConstPoints plastic_rest, ConstPoints current) {
  std::vector<Mat3> frames;
  for (int part = 0; part < parts.count; ++part) {
    std::vector<int> nodes;
    for (int n = 0; n < plastic_rest.rows(); ++n)
      if (parts.part_of_node[n] == part) nodes.push_back(n);
    const PointArray from = plastic_rest(nodes, Eigen::all), to = current(nodes, Eigen::all);
    frames.push_back(
        polar(Mat3((to.rowwise() - to.colwise().mean()).transpose() * (from.rowwise() - from.colwise().mean()))).R);
  }
  return frames;
}

/// One plastic step of a body: from `before` to `next`.
class Step {
 public:
  History next;
  FlowReport report;

  Step(const Model& model, ConstPoints x, const History& history)
      : next(history),
        model_(model),
        x_(x),
        before_(history),
        parts_(connected_parts(model.mesh, history.alive)),
        changed_(model.mesh.num_elements(), 0),
        rolled_back_(model.mesh.num_elements(), 0) {}

  /// Stretch, rotation, hardening, rest shape and volume of every element by itself.              theory.md 5.1 to 5.4
  void flow_elements(double dt) {
    std::vector<Mat3> frames;  // per element
    if (model_.maps_per_element() > 1 && model_.settings.rotation_frame == RotationFrame::kBestFit) {
      const std::vector<Mat3> of_part = fit_frames(parts_, before_.plastic_rest_positions, x_);
      for (int e = 0; e < model_.mesh.num_elements(); ++e)
        frames.push_back(before_.alive[e] ? of_part[part_of(e)] : Mat3(Mat3::Identity()));
    }
    plain::flow_elements(model_, x_, dt, frames, before_, next, outcomes_);
    for (int e = 0; e < model_.mesh.num_elements(); ++e) {
      if (!before_.alive[e]) continue;
      const ElementOutcome& outcome = outcomes_[e];
      if (model_.can_flow() && !(next.is_finite(e) && std::isfinite(outcome.dissipated)))
        throw NumericalError(fmt::format("the plastic history of hexahedron {} is not finite", e));
      changed_[e] = outcome.yielded || outcome.repaired || outcome.volume_error >= scalar::kVolumeAtRest;
      report.inverted += outcome.inverted;
      report.skipped += outcome.skipped;
      if (model_.can_flow() && outcome.volume_error >= scalar::kVolumeAtRest)
        report.worst_volume_error = std::max(report.worst_volume_error, outcome.volume_error);
    }
  }

  bool has_changed() const {
    return std::any_of(changed_.begin(), changed_.end(), [](auto c) { return c != 0; });
  }

  /// The joined rest shape. Where it would press an element flat, that element keeps its shape; where this does not
  /// suffice, its connected part does.                                                              theory.md 5.4, 5.5
  void join(LinearSolver& solver) {
    report.averaging = join_rest_shapes(model_, changed_, solver, next);
    std::vector<int> collapsing = find_collapsing();
    if (collapsing.empty()) return;
    for (const int e : collapsing) roll_back(e);
    next.plastic_rest_positions = before_.plastic_rest_positions;
    report.averaging = join_rest_shapes(model_, changed_, solver, next);

    std::vector<unsigned char> stays(parts_.count, 0);
    for (const int e : find_collapsing()) stays[part_of(e)] = 1;
    for (int e = 0; e < model_.mesh.num_elements(); ++e)
      if (before_.alive[e] && stays[part_of(e)]) roll_back(e);
    for (int n = 0; n < model_.mesh.num_nodes(); ++n)
      if (parts_.part_of_node[n] >= 0 && stays[parts_.part_of_node[n]])
        next.plastic_rest_positions.row(n) = before_.plastic_rest_positions.row(n);
  }

  /// Fracture.                                                                                            theory.md 5.7
  void remove_broken() {
    for (int e = 0; e < model_.mesh.num_elements(); ++e) {
      if (!outcomes_[e].yielded || !is_broken(model_, before_.yield_stress[e], next, e)) continue;
      next.alive[e] = 0;
      next.removed.push_back(e);
      ++report.removed;
    }
  }

  void count() {
    report.rolled_back = static_cast<int>(std::ranges::count(rolled_back_, 1));
    for (const ElementOutcome& outcome : outcomes_) {
      report.yielded += outcome.yielded;
      report.repaired += outcome.repaired;
      next.dissipated_energy += outcome.dissipated;
    }
  }

 private:
  ElementPoints rest_of(int e, const History& history) const {
    return gather(history.plastic_rest_positions, model_.mesh.hexahedra()[e]);
  }
  int part_of(int e) const { return parts_.part_of_node[model_.mesh.hexahedra()[e][0]]; }

  /// Elements with a corner that is nearly flat, and was less so before.
  std::vector<int> find_collapsing() const {
    std::vector<int> found;
    for (int e = 0; e < model_.mesh.num_elements(); ++e) {
      if (!before_.alive[e]) continue;
      const CornerValues initial = model_.corner_jacobian(e);
      const double now = min_jacobian_ratio(initial, rest_of(e, next));
      if (now < kCollapsedJacobian && now < min_jacobian_ratio(initial, rest_of(e, before_))) found.push_back(e);
    }
    return found;
  }

  /// Takes back the step of one element: its present shape becomes its rest shape.
  void roll_back(int e) {
    ElementHistory element = before_.element(model_, e);
    const ElementPoints x = about_mean(rest_of(e, before_));
    for (int i = 0; i < kCorners; ++i) element.rest_shape.row(i) = x.row(i) * element.rotation_map[i];
    next.set_element(e, element);
    outcomes_[e] = {};
    rolled_back_[e] = changed_[e];
  }

  const Model& model_;
  const ConstPoints x_;
  const History& before_;
  ConnectedParts parts_;
  std::vector<unsigned char> changed_;  // per element: its rest shape is another than before
  std::vector<ElementOutcome> outcomes_;
  std::vector<unsigned char> rolled_back_;
};

/// Without a mesh of plastic rest positions: each sample keeps its own deformation, and what its branches hold.
///                                                                                               theory.md 5.9, 5.10
FlowReport flow_isolated(const Model& model, ConstPoints x, double dt, History& history,
                         std::span<const BranchStep> steps) {
  FlowReport report;
  const Branches branches = history.branches(steps);
  History next = history;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    if (!history.alive[e]) continue;
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const ElementPoints initial = gather(model.mesh.positions(), corners), current = gather(x, corners);
    const Element element(initial, current, model.lame[e], model.settings, history.plastic_inverse_of(e),
                          branches.of(e));
    const IsolatedStep step = isolated_step(model, e, element.samples(), history, dt);
    report.inverted += step.inverted;
    report.skipped += step.skipped;
    report.yielded += step.yielded;
    set_isolated(e, step, next);
    next.dissipated_energy += step.dissipated;
    if (branches.any()) next.dissipated_energy += relax(e, element.samples(), model.lame[e], branches, next);
    if (branches.any() && step.yielded)
      relieve_branches(
          e, Element(initial, current, model.lame[e], model.settings, next.plastic_inverse_of(e)).samples(), next);
    if (!(next.is_finite(e) && std::isfinite(step.dissipated)))
      throw NumericalError(fmt::format("the plastic history of hexahedron {} is not finite", e));
    if (!step.yielded || !is_broken(model, history.yield_stress[e], next, e)) continue;
    next.alive[e] = 0;
    next.removed.push_back(e);
    ++report.removed;
  }
  if (report.yielded == 0 && !branches.any()) return report;
  next.version = history.version + 1;
  history = std::move(next);
  return report;
}

}  // namespace

FlowReport flow(const Model& model, ConstPoints x, double dt, LinearSolver& solver, History& history,
                std::span<const BranchStep> branches) {
  if (!model.has_rest_shapes() || !branches.empty()) return flow_isolated(model, x, dt, history, branches);
  Step step(model, x, history);
  step.flow_elements(dt);
  if (!model.can_flow() || !step.has_changed()) return step.report;
  step.join(solver);
  require_finite(step.next.plastic_rest_positions, "plastic rest position");
  step.remove_broken();
  step.count();
  step.next.version = history.version + 1;
  history = std::move(step.next);
  return step.report;
}

}  // namespace hexaplast::plain
