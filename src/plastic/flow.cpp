// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "plastic/flow_pass.hpp"
#include "plastic/fracture.hpp"
#include "plastic/isolated_flow.hpp"

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
  }
  const double guard = (1 + kSinglePrecision) * model.settings.inversion_threshold;
  return screen[YieldScreen::kMinDet * kBlock] > guard;
}

/// Finds the elements that stay as they are. False when no other is left.
bool find_idle(const Model& model, const Linearization& at, const History& history, bool relaxes, FlowWorkspace& work) {
  const bool is_screened = !relaxes && at.is_current && at.is_screened;
  parallel_for(model.mesh.num_elements(), [&](int e) {
    work.flows[e] = {.idle = !history.alive[e] || (is_screened && does_not_flow(model, at, e, history))};
  });
  return !std::ranges::all_of(work.flows, &ElementFlow::idle);
}

/// All that flows and relaxes of one element, bit for bit.
void copy(const History& from, int e, History& to) {
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

/// Exchanges what relaxes, and what flows where something can.
void swap(bool flows, History& a, History& b) {
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

/// One step of one element: history -> work.trial, work.flows.
void flow_alone(const Model& model, const Linearization& at, double dt, const History& history,
                const Branches& branches, int e, FlowWorkspace& work) {
  const Hexahedron& corners = model.mesh.hexahedra()[e];
  const Lame& k = model.lame[e];
  const ElementPoints rest = gather(history.plastic_rest_positions, corners), current = gather(at.x, corners);
  const ElementSamples samples =
      element_samples(rest, current, k, model.settings, history.plastic_inverse_of(e), branches.of(e));
  const IsolatedStep step = isolated_step(model, e, samples, history, dt);
  copy(history, e, work.trial);
  set_isolated(e, step, work.trial);
  work.flows[e] = {
      .yielded = step.yielded, .inverted = step.inverted, .skipped = step.skipped, .dissipated = step.dissipated};
  if (!branches.any()) return;
  work.flows[e].dissipated += relax(e, samples, k, branches, work.trial);
  if (step.yielded)
    relieve_branches(e, element_samples(rest, current, k, model.settings, work.trial.plastic_inverse_of(e)),
                     work.trial);
}

/// Flow of every live element: history -> work.trial, work.flows. False when none has anything to do; the trial is then
/// not made.
bool flow_elements(const Model& model, const Linearization& at, double dt, const History& history,
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
        work.differs[block] = 1;
      else if (differs)
        copy(history, e, work.trial);
    }
    if (work.differs[block] == 0) return;
    const std::uint32_t left = flow_block(model, at, dt, history, branches, block, work.trial, work.flows.data());
    for (int place = 0; place < kBlock; ++place) {
      const int e = model.partition->element(block, place);
      if (e < 0 || work.flows[e].idle) continue;
      if (left >> place & 1) flow_alone(model, at, dt, history, branches, e, work);
      ElementFlow& f = work.flows[e];
      if (!history.has_flowed.empty()) work.trial.has_flowed[e] = history.has_flowed[e] || f.yielded;
      f.overflowed = !work.trial.is_finite(e) || !std::isfinite(f.dissipated);
    }
  });
  work.version = history.version;
  return true;
}

/// Removes the elements that broke in this step; returns how many. With Fracture::kFace they stay.
int remove_broken(const Model& model, const History& history, FlowWorkspace& work) {
  int count = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    if (!work.flows[e].yielded || !is_broken(model, history.yield_stress[e], work.trial, e)) continue;
    if (work.tear) {
      work.tear->broken.push_back(e);
      continue;
    }
    work.trial.alive[e] = 0;
    work.trial.removed.push_back(e);
    ++count;
  }
  return count;
}

}  // namespace

FlowWorkspace::FlowWorkspace(const Model& model, const History& history)
    : trial(history), flows(model.mesh.num_elements()), differs(model.partition->num_blocks, 1) {
  trial.removed.reserve(model.mesh.num_elements());  // a step allocates nothing
  trial.rest_shape = {};
  trial.rotation_map = {};
  trial.plastic_rest_positions = trial.averaging_increment = PointArray(0, 3);
  if (may_tear(model.materials, model.settings)) tear.emplace(model);
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

FlowReport flow(const Model& model, const Linearization& at, double dt, History& history, FlowWorkspace& work,
                std::span<const BranchStep> steps) {
  const Branches branches = history.branches(steps);
  FlowReport report;
  if (work.tear) work.tear->broken.clear();
  if (!flow_elements(model, at, dt, history, branches, work)) return report;
  for (std::size_t e = 0; e < work.flows.size(); ++e) {
    const ElementFlow& f = work.flows[e];
    if (f.overflowed) throw NumericalError(fmt::format("the plastic history of hexahedron {} is not finite", e));
    report.yielded += f.yielded;
    report.inverted += f.inverted;
    report.skipped += f.skipped;
  }
  if (report.yielded == 0 && !branches.any()) return report;

  work.trial.dissipated_energy = history.dissipated_energy;
  work.trial.alive = history.alive;
  work.trial.removed = history.removed;
  report.removed = remove_broken(model, history, work);
  for (const ElementFlow& f : work.flows) work.trial.dissipated_energy += f.dissipated;
  swap(model.can_flow(), history, work.trial);
  work.version = ++history.version;
  return report;
}

}  // namespace hexaplast
