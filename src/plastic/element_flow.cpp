// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plastic/element_flow.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/sampling.hpp"
#include "mesh/trilinear.hpp"
#include "plastic/rest_shape.hpp"

namespace hexaplast {

namespace {

/// Stretch at every corner: what flows, and what it does to thresholds and accumulated quantities.
void flow_stretch(const FlowInput& at, double dt, ElementStep& step) {
  for (int i = 0; i < kCorners; ++i) {
    StretchFlow& flow = step.stretch[i];
    flow = stretch_flow(at.samples.polar[i].S, at.samples.stress[i], at.settings.yield_norm, step.next.yield_stress[i],
                        at.material.flow_rate, dt, at.settings.law);
    if (!std::isfinite(flow.norm)) step.dissipated = flow.norm;  // an overflow, which whoever takes the step refuses
    if (flow.fraction == 0) continue;
    step.yielded = true;
    step.dissipated += at.samples.volume / kCorners * flow.dissipated;
    step.next.plastic_strain[i] += flow.strain;
    step.next.yield_stress[i] = hardened(step.next.yield_stress[i], at.material.hardening, flow.fraction, flow.norm);
  }
}

/// Rotation at every corner, relative to the centre (objective) or to the frame (the paper's modes, eq. 33 and 34).
void flow_rotation(const FlowInput& at, double dt, ElementStep& step) {
  step.R_centre = polar(centre_jacobian(at.current) * centre_jacobian(at.x).inverse()).R;
  const Mat3 pose = at.frame.transpose() * step.R_centre;
  const double pose_angle = rotation_log(pose).norm();

  CornerValues angle;  // phi
  for (int i = 0; i < kCorners; ++i) angle[i] = rotation_log(step.R_centre.transpose() * at.samples.polar[i].R).norm();
  const double largest_angle = *std::max_element(angle.begin(), angle.end());

  for (int i = 0; i < kCorners; ++i) {
    RotationFlow& flow = step.rotation[i];
    const double threshold = step.next.rotation_yield[i], rate = at.material.rotation_flow_rate;
    switch (at.settings.rotation_plasticity) {
      case RotationPlasticity::kObjective:
        flow = rotation_flow(step.R_centre.transpose() * at.samples.polar[i].R, angle[i], 0, threshold, rate, dt);
        break;
      case RotationPlasticity::kVertex:
        flow = rotation_flow(at.frame.transpose() * at.samples.polar[i].R, angle[i], pose_angle, threshold, rate, dt);
        break;
      case RotationPlasticity::kCentre:
        flow = rotation_flow(pose, largest_angle, pose_angle, threshold, rate, dt);
        break;
      case RotationPlasticity::kNone:
        break;
    }
    if (flow.fraction == 0) continue;
    step.yielded = true;
    step.next.rotation_yield[i] = hardened(threshold, at.material.hardening, flow.fraction, flow.angle);
  }
}

/// Takes the increments into the rest shape; in the paper's modes rotation goes into the maps instead (eq. 35).
void apply_increments(const FlowInput& at, ElementStep& step) {
  const bool objective = at.settings.rotation_plasticity == RotationPlasticity::kObjective;
  CornerTensors increments;
  for (int i = 0; i < kCorners; ++i) {
    increments[i] = step.stretch[i].increment;
    if (objective) increments[i] = step.rotation[i].increment * increments[i];
  }
  if (const double fraction = sampling_of(at.settings).increment_weight(); fraction != 1) {
    Mat3 mean = Mat3::Zero();
    for (const Mat3& increment : increments) mean += increment / kCorners;
    for (Mat3& increment : increments) increment = mean + fraction * (increment - mean);
  }
  if (at.tracks_stretch)
    for (int i = 0; i < kCorners; ++i) {
      const Mat3& Pi = step.next.rotation_map[i];
      step.next.plastic_stretch[i] = Pi.transpose() * step.stretch[i].increment * Pi * step.next.plastic_stretch[i];
    }
  deform_rest_shape(increments, step.next.rotation_map, step.next.rest_shape);
  if (!objective)
    for (int i = 0; i < kCorners; ++i)
      step.next.rotation_map[i] = step.rotation[i].increment * step.next.rotation_map[i];
}

}  // namespace

double min_jacobian_ratio(const CornerValues& initial, const ElementPoints& x) {
  double min = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kCorners; ++i) min = std::min(min, corner_jacobian(x, i).determinant() / initial[i]);
  return min;
}

bool is_broken(const Material& material, const CornerValues& yield_stress_before, const CornerValues& yield_stress,
               const CornerTensors* plastic_stretch) {
  for (int i = 0; i < kCorners && std::isfinite(material.fracture_stress); ++i) {
    const double tau = yield_stress[i];
    if (tau > yield_stress_before[i] && tau > material.fracture_stress) return true;
  }
  if (!std::isfinite(material.fracture_stretch)) return false;
  return std::any_of(plastic_stretch->begin(), plastic_stretch->end(), [&](const Mat3& Fp) {
    if (Fp.norm() < material.fracture_stretch) return false;  // no singular value is above the norm
    return Eigen::JacobiSVD<Mat3>(Fp).singularValues()[0] > material.fracture_stretch;
  });
}

bool is_broken(const Model& model, const History& before, const History& next, int element) {
  const Material& material = model.material(element);
  CornerTensors of_isolated;  // F^p
  const CornerTensors* stretch = next.plastic_stretch.empty() ? nullptr : &next.plastic_stretch[element];
  if (!next.plastic_inverse.empty() && std::isfinite(material.fracture_stretch)) {
    for (int i = 0; i < kCorners; ++i) of_isolated[i] = next.plastic_inverse[element][i].inverse();
    stretch = &of_isolated;
  }
  return is_broken(material, before.yield_stress[element], next.yield_stress[element], stretch);
}

ElementStep flow_element(const FlowInput& at, const ElementHistory& before, double dt) {
  ElementStep step;
  step.next = before;

  // guard: nothing flows in an element that is inverted or nearly so, at its current or its plastic rest positions
  double min_det = std::numeric_limits<double>::infinity();
  for (const Mat3& F : at.samples.F) min_det = std::min(min_det, F.determinant());
  const double min_jacobian = min_jacobian_ratio(at.corner_jacobian, at.x);
  step.inverted = min_det < 0;
  step.skipped = std::min(min_det, min_jacobian) < at.settings.inversion_threshold;

  const bool stretches = can_stretch(at.material), rotates = can_rotate(at.material, at.settings);
  if (!step.skipped && (stretches || rotates)) {
    if (stretches) flow_stretch(at, dt, step);
    if (rotates) flow_rotation(at, dt, step);
    if (step.yielded) apply_increments(at, step);
  }

  if (min_jacobian < at.settings.inversion_threshold) {
    repair_rest_shape(at.initial_shape, dt, step.next.rest_shape);
    step.repaired = true;
  }
  step.volume_ratio = at.samples.volume / at.initial_volume;
  restore_volume(step.volume_ratio, at.settings.volume_restitution, dt, step.next.rest_shape);
  return step;
}

}  // namespace hexaplast
