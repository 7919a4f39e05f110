// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/finite.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "plastic/element_flow.hpp"
#include "plastic/flow_pass.hpp"
#include "plastic/isolated_flow.hpp"
#include "plastic/rest_shape.hpp"

namespace hexaplast {

namespace {

// Errors of single precision: of the screen as a fraction, and of a stress in mixed precision, by the screen or by the
// flow, as a fraction of the stiffness.
constexpr double kSinglePrecision = 1e-5, kSingleStress = 2e-6;

/// Errors of F^e = F G of isolated rest shapes over those of F: at least |G| |G^-1|, about.
double amplification(const Linearization& at, int place) {
  const float* mean_plastic = at.mean_plastic_of(place / kBlock);
  if (!mean_plastic) return 1;
  double squares = 0;
  for (int k = 0; k < kMeanPlastic; ++k) squares += std::pow(mean_plastic[k * kBlock + place % kBlock], 2);
  return squares * squares / 3;
}

/// Whether the plastic step would leave an element as it is but for its volume, as far as single precision can tell.
/// Errs on the safe side.
bool does_not_flow(const Model& model, const Linearization& at, int e, const History& history) {
  const int place = model.partition->place_of_element[e];
  const float* screen =
      at.screen.data() + static_cast<std::size_t>(place / kBlock) * YieldScreen::kQuantities * kBlock + place % kBlock;
  const Material& material = model.material(e);
  const double error = model.settings.precision == Precision::kMixed
                           ? kSingleStress * (2 * model.lame[e].mu + model.lame[e].lambda) * amplification(at, place)
                           : 0;
  for (int i = 0; i < kCorners; ++i) {
    if (!(screen[(YieldScreen::kNorm + i) * kBlock] + error < (1 - kSinglePrecision) * history.yield_stress[e][i]) &&
        material.flow_rate > 0)
      return false;
    if (model.can_rotate && material.rotation_flow_rate > 0 &&
        !(screen[(YieldScreen::kCosine + i) * kBlock] > std::cos(history.rotation_yield[e][i]) + kSinglePrecision))
      return false;
  }
  const double guard = (1 + kSinglePrecision) * model.settings.inversion_threshold;
  return screen[YieldScreen::kMinDet * kBlock] > guard &&
         (model.settings.rest_shape == RestShape::kIsolated ||
          screen[YieldScreen::kMinJacobian * kBlock] > guard * model.largest_jacobian[e]);
}

/// All of one element of a history into another, bit for bit, but for the rotation map and the rest shape.
void copy_others(const History& from, int e, History& to) {
  to.yield_stress[e] = from.yield_stress[e];
  if (!from.rotation_yield.empty()) to.rotation_yield[e] = from.rotation_yield[e];
  to.plastic_strain[e] = from.plastic_strain[e];
  if (!from.plastic_stretch.empty()) to.plastic_stretch[e] = from.plastic_stretch[e];
}

/// Finds the elements that stay as they are, or have but their volume restored. False when no other is left.
bool find_idle(const Model& model, const Linearization& at, const History& history, bool relaxes, FlowWorkspace& work) {
  parallel_for(model.mesh.num_elements(), [&](int e) {
    ElementFlow& f = work.flows[e] = {};
    f.idle = !history.alive[e];
    if (f.idle || relaxes || !at.is_current || !at.is_screened || !does_not_flow(model, at, e, history)) return;
    f.idle = model.settings.rest_shape == RestShape::kIsolated;
    if (f.idle) return;
    f.volume_error = std::abs(at.volume[model.partition->place_of_element[e]] / model.volume[e] - 1);
    f.restores = f.volume_error >= kVolumeAtRest;
    if (f.restores) return;
    f.idle = true;
    f.volume_error = 0;
  });
  return std::any_of(work.flows.begin(), work.flows.end(), [](const ElementFlow& f) { return !f.idle; });
}

/// All that flows and relaxes of one element without averaging, bit for bit.
void copy_isolated(const History& from, int e, History& to) {
  if (!from.plastic_inverse.empty()) {
    to.plastic_inverse[e] = from.plastic_inverse[e];
    to.has_flowed[e] = from.has_flowed[e];
  }
  to.yield_stress[e] = from.yield_stress[e];
  to.plastic_strain[e] = from.plastic_strain[e];
  if (from.branch_stretch.empty()) return;
  to.branch_stretch[e] = from.branch_stretch[e];
  std::ranges::copy(from.branch_strains_of(e), to.branch_strains_of(e).begin());
}

/// Exchanges what relaxes without averaging, and what flows where something can.
void swap_isolated(bool flows, History& a, History& b) {
  if (flows) {
    std::swap(a.plastic_inverse, b.plastic_inverse);
    std::swap(a.has_flowed, b.has_flowed);
    std::swap(a.yield_stress, b.yield_stress);
    std::swap(a.plastic_strain, b.plastic_strain);
  }
  std::swap(a.dissipated_energy, b.dissipated_energy);
  std::swap(a.alive, b.alive);
  std::swap(a.removed, b.removed);
  std::swap(a.branch_strain, b.branch_strain);
  std::swap(a.branch_stretch, b.branch_stretch);
}

/// Flow of every live element: history -> work.trial, work.flows. False when none has anything to do; the trial is then
/// not made.
bool flow_elements(const Model& model, const Linearization& at, double dt, const History& history,
                   FlowWorkspace& work) {
  if (!find_idle(model, at, history, false, work)) return false;
  const Mat3 axes = Mat3::Identity();
  const auto flow_alone = [&](int e) {
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const ElementPoints plastic_rest = gather(history.plastic_rest_positions, corners), current = gather(at.x, corners);
    const ElementSamples samples = element_samples(plastic_rest, current, model.lame[e], model.settings);
    const FlowInput input{.material = model.material(e),
                          .settings = model.settings,
                          .initial_shape = model.initial_shape(e),
                          .corner_jacobian = model.corner_jacobian(e),
                          .initial_volume = model.volume[e],
                          .x = plastic_rest,
                          .samples = samples,
                          .current = current,
                          .frame = axes,
                          .tracks_stretch = model.tracks_plastic_stretch};
    const ElementStep step = flow_element(input, history.element(e), dt);
    // what has but its volume restored is the same whoever does it
    const bool restores = !step.yielded && !step.repaired && std::isfinite(step.dissipated);
    work.trial.set_element(e, restores ? history.element(e) : step.next);
    work.flows[e] = {.restores = restores,
                     .yielded = step.yielded,
                     .inverted = step.inverted,
                     .skipped = step.skipped,
                     .repaired = step.repaired,
                     .volume_error = std::abs(step.volume_ratio - 1),
                     .dissipated = step.dissipated};
  };

  const bool knows_trial = work.version == history.version;
  parallel_for(model.partition->num_blocks, [&](int block) {
    const unsigned char before = knows_trial ? work.differs[block] : FlowWorkspace::kAll;
    unsigned char now = 0;
    bool restores = false;
    for (int place = 0; place < kBlock; ++place) {
      const int e = model.partition->element(block, place);
      if (e < 0) continue;
      const ElementFlow& f = work.flows[e];
      if (!f.idle && !f.restores) {
        now = FlowWorkspace::kAll;
        continue;
      }
      work.trial.rotation_map[e] = history.rotation_map[e];
      if (before == FlowWorkspace::kAll) copy_others(history, e, work.trial);
      if (f.restores)
        restores = true;
      else if (before != 0)
        work.trial.rest_shape[e] = history.rest_shape[e];
    }
    if (restores) restore_block(model, at, dt, history, block, work.trial, work.flows.data());
    work.differs[block] = restores ? now | FlowWorkspace::kRestShapes : now;
    if (now != FlowWorkspace::kAll) return;
    const std::uint32_t left = flow_block(model, at, dt, history, {}, block, work.trial, work.flows.data());
    restores = false;
    for (int place = 0; place < kBlock; ++place) {
      if (!(left >> place & 1)) continue;
      const int e = model.partition->element(block, place);
      flow_alone(e);
      restores = restores || work.flows[e].restores;
    }
    if (restores) restore_block(model, at, dt, history, block, work.trial, work.flows.data());
    for (int place = 0; place < kBlock; ++place) {
      const int e = model.partition->element(block, place);
      if (e < 0 || work.flows[e].idle) continue;
      ElementFlow& f = work.flows[e];
      const bool is_alone = left >> place & 1;
      if (!is_alone)
        work.trial.rotation_map[e] = history.rotation_map[e];  // of a part at rest, which the averaging leaves alone
      if (!f.restores || is_alone) f.overflowed = !work.trial.is_finite(e) || !std::isfinite(f.dissipated);
    }
  });
  work.version = history.version;
  return true;
}

/// Takes back the step of one element: its present plastic rest shape becomes its rest shape.
void roll_back(const Model& model, int e, const History& history, FlowWorkspace& work) {
  ElementHistory element = history.element(e);
  const ElementPoints x = about_mean(gather(history.plastic_rest_positions, model.mesh.hexahedra()[e]));
  for (int i = 0; i < kCorners; ++i) element.rest_shape.row(i) = x.row(i) * element.rotation_map[i];
  work.trial.set_element(e, element);
  work.differs[model.partition->place_of_element[e] / kBlock] = FlowWorkspace::kAll;
  ElementFlow& f = work.flows[e];
  f.rolled_back = work.changed[e];
  f.yielded = f.repaired = false;
  f.dissipated = 0;
}

/// Marks elements that the averaging pressed towards inversion; returns how many.
int mark_collapsing(const Model& model, const History& history, FlowWorkspace& work) {
  AlignedVector<double>& plastic_rest = work.averaging->slots().first;
  to_slots(*model.partition, work.trial.plastic_rest_positions, plastic_rest);
  const auto is_collapsing = [&](int e) {
    const auto ratio = [&](const History& of) {
      return min_jacobian_ratio(model.corner_jacobian(e), gather(of.plastic_rest_positions, model.mesh.hexahedra()[e]));
    };
    const double now = ratio(work.trial);
    return now < kCollapsedJacobian && now < ratio(history);
  };
  parallel_for(model.partition->num_blocks, [&](int block) {
    const std::uint32_t near = nearly_collapsed(model, plastic_rest.data(), kCollapsedJacobian, block);
    for (int place = 0; place < kBlock; ++place) {
      const int e = model.partition->element(block, place);
      if (e >= 0) work.flows[e].collapsing = (near >> place & 1) && history.alive[e] && is_collapsing(e);
    }
  });
  return static_cast<int>(
      std::count_if(work.flows.begin(), work.flows.end(), [](const ElementFlow& f) { return f.collapsing; }));
}

/// Rest-shape averaging that never inverts an element.
AveragingReport average_safely(const Model& model, LinearSolver& solver, const History& history, FlowWorkspace& work) {
  AveragingReport report = work.averaging->advance(model, solver, work.trial, work.changed);
  if (mark_collapsing(model, history, work) == 0) return report;

  for (int e = 0; e < model.mesh.num_elements(); ++e)
    if (work.flows[e].collapsing) roll_back(model, e, history, work);
  work.trial.plastic_rest_positions = history.plastic_rest_positions;
  report = work.averaging->advance(model, solver, work.trial, work.changed);
  if (mark_collapsing(model, history, work) == 0) return report;

  // what else the elements of a connected part do decides over these: the part stays as it is, the others go on
  const std::vector<int>& part_of_node = work.averaging->parts(model, history).part_of_node;
  const auto part_of = [&](int e) { return part_of_node[model.mesh.hexahedra()[e][0]]; };
  work.stays.assign(work.averaging->parts(model, history).count, 0);
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    if (work.flows[e].collapsing) work.stays[part_of(e)] = 1;
  for (int e = 0; e < model.mesh.num_elements(); ++e)
    if (history.alive[e] && work.stays[part_of(e)]) roll_back(model, e, history, work);
  for (int n = 0; n < model.mesh.num_nodes(); ++n)
    if (part_of_node[n] >= 0 && work.stays[part_of_node[n]])
      work.trial.plastic_rest_positions.row(n) = history.plastic_rest_positions.row(n);
  return report;
}

/// One step of one element with isolated rest shapes: history -> work.trial, work.flows.
void flow_isolated_alone(const Model& model, const Linearization& at, double dt, const History& history,
                         const Branches& branches, int e, FlowWorkspace& work) {
  const Hexahedron& corners = model.mesh.hexahedra()[e];
  const Lame& k = model.lame[e];
  const ElementPoints rest = gather(history.plastic_rest_positions, corners), current = gather(at.x, corners);
  const ElementSamples samples =
      element_samples(rest, current, k, model.settings, history.plastic_inverse_of(e), branches.of(e));
  const IsolatedStep step = isolated_step(model, e, samples, history, dt);
  copy_isolated(history, e, work.trial);
  set_isolated(e, step, work.trial);
  work.flows[e] = {
      .yielded = step.yielded, .inverted = step.inverted, .skipped = step.skipped, .dissipated = step.dissipated};
  if (!branches.any()) return;
  work.flows[e].dissipated += relax(e, samples, k.mu, branches.steps, work.trial);
  if (step.yielded)
    relieve_branches(e, element_samples(rest, current, k, model.settings, work.trial.plastic_inverse_of(e)),
                     work.trial);
}

/// flow_elements of isolated rest shapes, and of those that stay.
bool flow_isolated_elements(const Model& model, const Linearization& at, double dt, const History& history,
                            const Branches& branches, FlowWorkspace& work) {
  if (!find_idle(model, at, history, branches.any(), work)) return false;
  const bool knows_trial = work.version == history.version;
  parallel_for(model.partition->num_blocks, [&](int block) {
    const bool differs = !knows_trial || work.differs[block] != 0;
    work.differs[block] = 0;
    for (int place = 0; place < kBlock; ++place) {
      const int e = model.partition->element(block, place);
      if (e < 0) continue;
      if (!work.flows[e].idle)
        work.differs[block] = FlowWorkspace::kAll;
      else if (differs)
        copy_isolated(history, e, work.trial);
    }
    if (work.differs[block] == 0) return;
    const std::uint32_t left = flow_block(model, at, dt, history, branches, block, work.trial, work.flows.data());
    for (int place = 0; place < kBlock; ++place) {
      const int e = model.partition->element(block, place);
      if (e < 0 || work.flows[e].idle) continue;
      if (left >> place & 1) flow_isolated_alone(model, at, dt, history, branches, e, work);
      ElementFlow& f = work.flows[e];
      if (!history.has_flowed.empty()) work.trial.has_flowed[e] = history.has_flowed[e] || f.yielded;
      f.overflowed = !work.trial.is_finite(e) || !std::isfinite(f.dissipated);
    }
  });
  work.version = history.version;
  return true;
}

/// Removes the elements that broke in this step; returns how many.
int remove_broken(const Model& model, const History& history, FlowWorkspace& work) {
  int count = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    if (!work.flows[e].yielded || !is_broken(model, history, work.trial, e)) continue;
    work.trial.alive[e] = 0;
    work.trial.removed.push_back(e);
    ++count;
  }
  return count;
}

}  // namespace

FlowWorkspace::FlowWorkspace(const Model& model, const History& history)
    : trial(history),
      flows(model.mesh.num_elements()),
      changed(model.mesh.num_elements()),
      differs(model.partition->num_blocks, kAll) {
  trial.removed.reserve(model.mesh.num_elements());  // a step allocates nothing
  if (model.settings.rest_shape == RestShape::kJoined && model.settings.num_branches() == 0) {
    averaging.emplace(model);
  } else {
    trial.rest_shape = {};
    trial.rotation_map = {};
    trial.plastic_rest_positions = trial.averaging_increment = PointArray(0, 3);
  }
}

FlowReport count_inverted(const Model& model, const Linearization& at) {
  FlowReport report;
  for (int block = 0; block < model.partition->num_blocks; ++block) {
    const float* min_det = at.screen.data() + static_cast<std::size_t>(block) * YieldScreen::kQuantities * kBlock +
                           YieldScreen::kMinDet * kBlock;
    for (int place = 0; place < kBlock; ++place) {
      if (!(at.present[block] >> place & 1)) continue;
      report.inverted += min_det[place] < 0;
      report.skipped += min_det[place] < model.settings.inversion_threshold;
    }
  }
  return report;
}

FlowReport flow(const Model& model, const Linearization& at, double dt, LinearSolver& solver, History& history,
                FlowWorkspace& work, std::span<const BranchStep> steps) {
  const Branches branches = history.branches(steps);
  FlowReport report;
  if (!(work.averaging ? flow_elements(model, at, dt, history, work)
                       : flow_isolated_elements(model, at, dt, history, branches, work)))
    return report;
  for (std::size_t e = 0; e < work.flows.size(); ++e) {
    const ElementFlow& f = work.flows[e];
    if (f.overflowed) throw NumericalError(fmt::format("the plastic history of hexahedron {} is not finite", e));
    report.yielded += f.yielded;
    report.inverted += f.inverted;
    report.skipped += f.skipped;
    report.repaired += f.repaired;
    report.worst_volume_error = std::max(report.worst_volume_error, f.volume_error);
    work.changed[e] = f.yielded || f.repaired || f.volume_error >= kVolumeAtRest;
  }
  if (report.yielded == 0 && report.repaired == 0 && report.worst_volume_error < kVolumeAtRest && !branches.any())
    return report;

  work.trial.dissipated_energy = history.dissipated_energy;
  work.trial.alive = history.alive;
  work.trial.removed = history.removed;
  if (work.averaging) {
    work.trial.plastic_rest_positions = history.plastic_rest_positions;
    work.trial.averaging_increment = history.averaging_increment;
    report.averaging = average_safely(model, solver, history, work);
    require_finite(work.trial.plastic_rest_positions, "plastic rest position");
  }
  report.removed = remove_broken(model, history, work);
  report.yielded = report.repaired = 0;  // averaging may have taken some back
  for (const ElementFlow& f : work.flows) {
    report.yielded += f.yielded;
    report.repaired += f.repaired;
    report.rolled_back += f.rolled_back;
    work.trial.dissipated_energy += f.dissipated;
  }
  if (work.averaging) {
    work.trial.version = history.version + 1;
    std::swap(history, work.trial);
  } else {
    swap_isolated(model.can_flow(), history, work.trial);
    ++history.version;
  }
  work.version = history.version;
  return report;
}

}  // namespace hexaplast
