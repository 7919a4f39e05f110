// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/plastic/flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hexaplast/base/error.hpp"
#include "hexaplast/base/parallel.hpp"
#include "hexaplast/plastic/point_flow.hpp"
#include "hexaplast/plastic/rest_shape.hpp"

namespace hexaplast {

namespace {

constexpr double kVolumeAtRest = 1e-14;      // a volume error below is rounding
constexpr double kCollapsedJacobian = 0.02;  // of the original: averaging may not press a corner below

/// Smallest det J_i(x) / det J_i(X) of an element's corners.
double least_jacobian_ratio(const Model& model, int e, const ElementPoints& x) {
  double least = 1e300;
  for (int i = 0; i < kCorners; ++i)
    least = std::min(least, corner_jacobian(x, i).determinant() / model.corner_jacobian[e][i]);
  return least;
}

/// Flow of one element at world corners: history[e] -> trial[e].
ElementFlow flow_element(const Model& model, int e, const RestOperator& rest, const ElementPoints& world,
                         const History& history, double dt, History& trial) {
  const Material& material = model.material(e);
  const Settings& settings = model.settings;
  const ElementPoints x = gather(history.material, model.mesh.hexahedra()[e]);
  const std::array<Mat3, kCorners> F = deformation_gradients(rest, world);
  ElementFlow out;

  ElementPoints& y = trial.rest_shape[e];
  y = history.rest_shape[e];
  trial.rotation_map[e] = history.rotation_map[e];
  trial.yield_stress[e] = history.yield_stress[e];
  trial.rotation_yield[e] = history.rotation_yield[e];
  trial.plastic_strain[e] = history.plastic_strain[e];

  // guard: nothing flows in an element that is inside out or nearly so, in the world or in the material
  double least_det = 1e300;
  for (const Mat3& Fi : F) least_det = std::min(least_det, Fi.determinant());
  const double least_jacobian = least_jacobian_ratio(model, e, x);
  out.inverted = least_det < 0;
  out.guarded = least_det < settings.inversion_threshold || least_jacobian < settings.inversion_threshold;

  const bool stretches = material.flow_rate > 0 && std::isfinite(material.yield_stress);
  const bool rotates = settings.rotation == RotationPlasticity::kObjective && material.rotation_flow_rate > 0;
  if (!out.guarded && (stretches || rotates)) {
    const Mat3 R_centre =
        rotates ? polar(centre_jacobian(world) * centre_jacobian(x).inverse()).R : Mat3(Mat3::Identity());
    std::array<Mat3, kCorners> increments;
    for (int i = 0; i < kCorners; ++i) {
      const Polar at = polar(F[i]);
      const StretchFlow stretch =
          stretch_flow(at.S, model.lame[e], settings.yield_norm, history.yield_stress[e][i], material.flow_rate, dt);
      increments[i] = stretch.increment;
      out.yielded = out.yielded || stretch.share > 0;
      out.dissipated += rest.volume / kCorners * stretch.dissipated;
      trial.plastic_strain[e][i] += stretch.strain;
      if (stretch.share > 0)
        trial.yield_stress[e][i] =
            std::max(0.0, trial.yield_stress[e][i] + material.hardening * stretch.share * stretch.norm);

      if (!rotates) continue;
      const RotationFlow turn =
          rotation_flow(at.R, R_centre, history.rotation_yield[e][i], material.rotation_flow_rate, dt);
      if (turn.share == 0) continue;
      increments[i] = turn.increment * increments[i];
      out.yielded = true;
      trial.rotation_yield[e][i] =
          std::max(0.0, trial.rotation_yield[e][i] + material.hardening * turn.share * turn.angle);
    }
    if (out.yielded) deform_rest_shape(increments, history.rotation_map[e], y);
  }

  if (least_jacobian < settings.inversion_threshold) {
    repair_rest_shape(model.original_shape[e], dt, y);
    out.repaired = true;
  }
  const double volume_ratio = rest.volume / model.volume[e];
  out.volume_error = std::abs(volume_ratio - 1);
  if (out.volume_error >= kVolumeAtRest) restore_volume(volume_ratio, settings.volume_restitution, dt, y);
  return out;
}

/// Takes back the flow of one element: its present material shape becomes its rest shape.
void adopt_material_shape(const Model& model, int e, const History& history, History& trial, ElementFlow& flow) {
  const ElementPoints x = about_mean(gather(history.material, model.mesh.hexahedra()[e]));
  trial.rest_shape[e] = x * history.rotation_map[e];
  trial.rotation_map[e] = history.rotation_map[e];
  trial.yield_stress[e] = history.yield_stress[e];
  trial.rotation_yield[e] = history.rotation_yield[e];
  trial.plastic_strain[e] = history.plastic_strain[e];
  flow.yielded = false;
  flow.dissipated = 0;
}

/// Marks elements that the averaging pressed towards inversion; returns how many.
int mark_collapsing(const Model& model, const History& history, const History& trial, std::vector<ElementFlow>& flows) {
  int count = 0;
  for (int e = 0; e < model.mesh.num_elements(); ++e) {
    const Hexahedron& corners = model.mesh.hexahedra()[e];
    const double now = least_jacobian_ratio(model, e, gather(trial.material, corners));
    flows[e].collapsing =
        now < kCollapsedJacobian && now < least_jacobian_ratio(model, e, gather(history.material, corners));
    count += flows[e].collapsing;
  }
  return count;
}

/// Rest-to-material averaging that never presses an element inside out.
AveragingReport average_safely(const Model& model, LinearSolver& solver, const History& history, FlowWorkspace& work) {
  AveragingReport report = work.averaging.step(model, solver, work.trial);
  if (mark_collapsing(model, history, work.trial, work.flows) == 0) return report;

  for (int e = 0; e < model.mesh.num_elements(); ++e)
    if (work.flows[e].collapsing) adopt_material_shape(model, e, history, work.trial, work.flows[e]);
  work.trial.material = history.material;
  report = work.averaging.step(model, solver, work.trial);
  if (mark_collapsing(model, history, work.trial, work.flows) == 0) return report;

  for (int e = 0; e < model.mesh.num_elements(); ++e)
    adopt_material_shape(model, e, history, work.trial, work.flows[e]);
  work.trial.material = history.material;
  return report;
}

void require_finite(ConstPoints x, const char* what) {
  if (x.allFinite()) return;
  for (int n = 0; n < x.rows(); ++n)
    if (!x.row(n).allFinite())
      throw NumericalError(
          fmt::format("the {} of node {} is not finite: ({}, {}, {})", what, n, x(n, 0), x(n, 1), x(n, 2)));
}

}  // namespace

FlowWorkspace::FlowWorkspace(const Model& model) : trial(model), averaging(model), flows(model.mesh.num_elements()) {}

FlowReport flow(const Model& model, const Linearization& at, ConstPoints x, double dt, LinearSolver& solver,
                History& history, FlowWorkspace& work) {
  require_finite(x, "position");
  parallel_for(model.mesh.num_elements(), [&](int e) {
    work.flows[e] = flow_element(model, e, at.rest[e], gather(x, model.mesh.hexahedra()[e]), history, dt, work.trial);
  });

  FlowReport report;
  const auto count = [&](bool ElementFlow::*mark) {
    return static_cast<int>(
        std::count_if(work.flows.begin(), work.flows.end(), [&](const ElementFlow& f) { return f.*mark; }));
  };
  report.inverted = count(&ElementFlow::inverted);
  report.guarded = count(&ElementFlow::guarded);
  report.repaired = count(&ElementFlow::repaired);
  for (const ElementFlow& f : work.flows)
    report.worst_volume_error = std::max(report.worst_volume_error, f.volume_error);
  const bool at_rest =
      count(&ElementFlow::yielded) == 0 && report.repaired == 0 && report.worst_volume_error < kVolumeAtRest;
  if (at_rest) return report;

  work.trial.material = history.material;
  work.trial.version = history.version;
  work.trial.dissipated_energy = history.dissipated_energy;
  report.averaging = average_safely(model, solver, history, work);
  require_finite(work.trial.material, "material position");
  report.yielded = count(&ElementFlow::yielded);
  for (const ElementFlow& f : work.flows) work.trial.dissipated_energy += f.dissipated;
  work.trial.version = history.version + 1;
  std::swap(history, work.trial);
  return report;
}

}  // namespace hexaplast
