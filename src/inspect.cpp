// SPDX-License-Identifier: LGPL-2.1-or-later
#include "inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/require.hpp"
#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "kinematics/polar.hpp"
#include "kinematics/sampling.hpp"
#include "mesh/trilinear.hpp"
#include "plain/plain.hpp"
#include "plastic/isolated_flow.hpp"

namespace hexaplast {

namespace {

constexpr double kExactAveraging = 1e-11;  // relative residual
constexpr double kMaxStepsOfPath = 1e9;    // from one point to the next

HexMesh mesh_of(const ElementPoints& initial) { return HexMesh(initial, {Hexahedron{0, 1, 2, 3, 4, 5, 6, 7}}); }

History history_of(const Model& model, const HexahedronState& state) {
  History history(model);
  history.plastic_rest_positions = state.plastic_rest;
  if (model.settings.rest_shape == RestShape::kIsolated && is_flowed(state.history.plastic_inverse))
    history.add_plastic_inverse();
  history.set_element(0, state.history);
  return history;
}

/// The plain implementation has every option.
Settings plainly(Settings settings) {
  settings.precision = Precision::kDouble;
  settings.implementation = Implementation::kPlain;
  return settings;
}

/// B: what the paper's rotation modes are measured against.                                          theory.md eq. 33
Mat3 frame_of(const HexahedronState& state, RotationFrame frame) {
  return frame == RotationFrame::kBestFit ? fit_rotation(about_mean(state.plastic_rest), about_mean(state.current))
                                          : Mat3(Mat3::Identity());
}

}  // namespace

HexahedronState initial_hexahedron(const ElementPoints& initial, const Material& material) {
  const Model model(mesh_of(initial), {material}, {.rest_shape = RestShape::kJoined});  // which every material has
  return {initial, initial, initial, History(model).element(model, 0)};
}

HexahedronElasticity inspect_elasticity(const HexahedronState& state, const Material& material,
                                        const Settings& settings) {
  const Model model(mesh_of(state.initial), {material}, plainly(settings));
  History history = history_of(model, state);
  const std::vector<BranchStep> branches;
  const std::unique_ptr<Backend> elasticity = plain::make_backend(model, history, branches);
  elasticity->linearize(state.current);
  const plain::Element element(state.plastic_rest, state.current, model.lame[0], model.settings,
                               history.plastic_inverse_of(0));

  HexahedronElasticity found;
  for (int i = 0; i < kCorners; ++i) found.corner_jacobian[i] = corner_jacobian(state.plastic_rest, i);
  found.sample_gradient = element.sample_gradients();
  if (sampling_of(settings).assumes_strain)
    for (ElementPoints& g : found.sample_gradient) g.setConstant(std::numeric_limits<double>::quiet_NaN());
  found.centre_jacobian = centre_jacobian(state.plastic_rest);
  found.volume = element.samples().volume;
  found.sample_volume = found.volume / kCorners;
  found.mean_gradient = element.mean_gradient();

  found.energy = elasticity->energy(state.current);
  PointArray force = PointArray::Zero(kCorners, 3);
  elasticity->add_force(force);
  found.force = force;
  BlockMatrix blocks(kCorners);
  elasticity->add_stiffness_blocks(-1, blocks);
  found.stiffness.setZero();
  for (int a = 0; a < kCorners; ++a)
    for (const auto& [b, block] : blocks.row(a)) found.stiffness.block<3, 3>(3 * a, 3 * b) = block;
  return found;
}

HexahedronStep inspect_step(const HexahedronState& state, const Material& material, const Settings& settings, double dt,
                            Names names) {
  require_time_step(dt);
  Settings exact = plainly(settings);
  exact.averaging_tolerance = kExactAveraging;
  const Model model(mesh_of(state.initial), {material}, exact);
  check_time_step(model.materials, settings, dt, names);
  const History before = history_of(model, state);
  const plain::Element element(state.plastic_rest, state.current, model.lame[0], settings,
                               before.plastic_inverse_of(0));
  ElementSamples samples = element.samples();
  const CornerTensors* G = before.plastic_inverse_of(0);
  IsolatedStress isolated;
  if (G) {
    isolated = isolated_stress(state.plastic_rest, *G, samples, settings.yield_stress_measure);
    samples.stress = isolated.relieved;
  }

  HexahedronStep found;
  found.F_centre = centre_jacobian(state.current) * centre_jacobian(state.plastic_rest).inverse();
  found.R_centre = polar(found.F_centre).R;
  found.F = samples.F;
  for (int i = 0; i < kCorners; ++i) {
    found.F_corner[i] = corner_jacobian(state.current, i) * corner_jacobian(state.plastic_rest, i).inverse();
    found.F_blended[i] = (found.F_corner[i] + found.F_centre) / 2;
    const Polar& decomposed = samples.polar[i];
    found.R[i] = decomposed.R;
    found.S[i] = decomposed.S;
    found.Q[i] = found.R_centre.transpose() * decomposed.R;
    found.phi[i] = rotation_log(found.Q[i]).norm();
    found.strain[i] = decomposed.S - Mat3::Identity();
    found.stress[i] = samples.stress[i];
    found.stress_norm[i] = stress_norm(found.stress[i], settings.yield_norm);
  }
  if (settings.rotation_plasticity == RotationPlasticity::kCentre)
    found.phi.fill(*std::max_element(found.phi.begin(), found.phi.end()));

  // the step as a body takes it
  History after = before;
  PreconditionedConjugateGradients solver = plain::averaging_solver(model);
  found.skipped = plain::flow(model, state.current, dt, solver, after).skipped > 0;

  // and what flows, corner by corner
  if (G) {
    const IsolatedStep step = isolated_flow(element.samples(), isolated, *G, model.lame[0].mu, model.material(0),
                                            settings.yield_norm, before.yield_stress[0], dt);
    for (int i = 0; i < kCorners; ++i) {
      found.stretch_flow_fraction[i] = found.skipped ? 0 : step.fraction[i];
      found.stretch_increment[i] = after.plastic_inverse[0][i].inverse() * (*G)[i];
    }
    found.rotation_flow_fraction.fill(0);
    found.rotation_increment.fill(Mat3::Identity());
    found.volume_ratio = 1;
  } else {
    const plain::ElementStep step =
        plain::flow_element(model, 0, state.plastic_rest, state.current, frame_of(state, settings.rotation_frame),
                            before.element(model, 0), dt);
    found.stretch_flow_fraction = step.stretch_fraction;
    found.stretch_increment = step.stretch;
    found.rotation_flow_fraction = step.rotation_fraction;
    found.rotation_increment = step.rotation;
    found.volume_ratio = step.volume_ratio;
  }

  found.history = after.element(model, 0);
  found.rest_volume = volume(found.history.rest_shape);
  found.plastic_rest = after.plastic_rest_positions;
  found.plastic_volume = volume(found.plastic_rest);
  return found;
}

void follow_path(const ElementPoints& initial, const Material& material, const Settings& settings, double dt,
                 const std::vector<PathPoint>& path, const std::function<void(const PathResponse&)>& report,
                 Names names) {
  if (path.empty()) throw InputError("a path needs at least one point");
  require_time_step(dt);
  for (std::size_t k = 1; k < path.size(); ++k)
    if (!(path[k].time > path[k - 1].time))
      throw InputError(fmt::format("path: time {} does not come after {}", path[k].time, path[k - 1].time));
  Body body(mesh_of(initial), {material}, plainly(settings));
  const auto respond = [&](double time, const Mat3& F) {
    const PointArray x = initial * F.transpose();
    body.set_time_step(0);  // what acts at the moment
    body.linearize(x);
    PointArray f = PointArray::Zero(kCorners, 3);
    body.add_force(f);
    const ElementFields fields = body.fields(x);
    report({.time = time,
            .F = F,
            .P = -(f.transpose() * initial) / body.initial_volume(),  // what the forces do on the corners
            .stress_norm = fields.stress_norm[0],
            .plastic_strain = fields.plastic_strain[0],
            .yield_stress = fields.yield_stress[0],
            .volume_ratio = fields.volume_ratio[0],
            .energy = body.energy(x),
            .dissipated_energy = body.dissipated_energy()});
  };

  respond(path.front().time, path.front().F);
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double span = path[k].time - path[k - 1].time;
    if (!(span / dt <= kMaxStepsOfPath))
      throw InputError(fmt::format("dt = {} s: makes {:.3g} steps of the path from {} s to {} s, at most {:.3g}", dt,
                                   span / dt, path[k - 1].time, path[k].time, kMaxStepsOfPath));
    const int steps = std::max(1, static_cast<int>(std::ceil(span / dt * (1 - 1e-9))));
    check_time_step({material}, settings, span / steps, names);
    for (int n = 1; n <= steps; ++n) {
      const double fraction = static_cast<double>(n) / steps;
      const Mat3 F = (1 - fraction) * path[k - 1].F + fraction * path[k].F;
      body.set_time_step(span / steps);
      body.flow(initial * F.transpose(), span / steps);
      respond(path[k - 1].time + fraction * span, F);
    }
  }
}

}  // namespace hexaplast
