// SPDX-License-Identifier: LGPL-2.1-or-later
// The formulas of the elements for one element, of doubles.
#define HEXAPLAST_ONE_NUMBER
#include <cmath>

#include "plain/flow-inl.hpp"
#include "plain/plain.hpp"

namespace hexaplast::plain {

namespace scalar = HWY_NAMESPACE;

namespace {

scalar::CornerLanes<double> corners_of(const ElementPoints& x) {
  scalar::CornerLanes<double> corners;
  for (int a = 0; a < kCorners; ++a)
    for (int k = 0; k < 3; ++k) corners.at[a][k] = x(a, k);
  return corners;
}
ElementPoints to_eigen(const scalar::CornerLanes<double>& corners) {
  ElementPoints x;
  for (int a = 0; a < kCorners; ++a)
    for (int k = 0; k < 3; ++k) x(a, k) = corners.at[a][k];
  return x;
}

void set(const ElementPoints& plastic_rest, const ElementPoints& current, const Lame& lame, const Settings& settings,
         const CornerTensors* plastic_inverse, const Branches& branches, scalar::Element<double>& element) {
  scalar::ElementState<double> state;
  scalar::Mat<double> G[kCorners];
  for (int i = 0; plastic_inverse && i < kCorners; ++i) G[i] = scalar::entries((*plastic_inverse)[i]);
  if (plastic_inverse) state.plastic_inverse = G;
  scalar::BranchLanes<double> of_branches;
  if (branches.any()) {
    of_branches = scalar::branches_of(branches, lame);
    state.branches = &of_branches;
  }
  element.set(corners_of(plastic_rest), corners_of(current), lame.mu, lame.lambda, settings, state);
}

scalar::JoinedHistory<double> numbers_of(const ElementHistory& history) {
  scalar::JoinedHistory<double> numbers;
  numbers.rest_shape = corners_of(history.rest_shape);
  for (int i = 0; i < kCorners; ++i) {
    numbers.rotation_map[i] = scalar::entries(history.rotation_map[i]);
    numbers.yield_stress[i] = history.yield_stress[i];
    numbers.rotation_yield[i] = history.rotation_yield[i];
    numbers.plastic_strain[i] = history.plastic_strain[i];
    numbers.plastic_stretch[i] = scalar::entries(history.plastic_stretch[i]);
  }
  return numbers;
}
void take(const scalar::JoinedHistory<double>& numbers, ElementHistory& history) {
  history.rest_shape = to_eigen(numbers.rest_shape);
  for (int i = 0; i < kCorners; ++i) {
    history.rotation_map[i] = scalar::to_eigen(numbers.rotation_map[i]);
    history.yield_stress[i] = numbers.yield_stress[i];
    history.rotation_yield[i] = numbers.rotation_yield[i];
    history.plastic_strain[i] = numbers.plastic_strain[i];
    history.plastic_stretch[i] = scalar::to_eigen(numbers.plastic_stretch[i]);
  }
}

}  // namespace

struct Element::Numbers {
  scalar::Element<double> element;
};

Element::Element(const ElementPoints& plastic_rest, const ElementPoints& current, const Lame& lame,
                 const Settings& settings, const CornerTensors* plastic_inverse, const Branches& branches) {
  auto numbers = std::make_unique<Numbers>();
  scalar::Element<double>& element = numbers->element;
  set(plastic_rest, current, lame, settings, plastic_inverse, branches, element);
  samples_.volume = element.volume();
  samples_.pressure = element.volume_pressure();
  samples_.volume_ratio = element.volume_excess + 1;
  for (int i = 0; i < kCorners; ++i) {
    samples_.F[i] = scalar::to_eigen(element.F[i]);
    samples_.polar[i] = {scalar::to_eigen(element.polar[i].R), scalar::to_eigen(matrix(element.polar[i].S))};
    samples_.stress[i] = scalar::to_eigen(matrix(element.yielding_stress(i)));
  }
  add_branch_stress(branches, lame, samples_);
  numbers_ = std::move(numbers);
}
Element::~Element() = default;

double Element::energy() const { return numbers_->element.energy(); }
ElementPoints Element::force() const { return to_eigen(numbers_->element.force()); }
ElementPoints Element::force_increment(const ElementPoints& dx) const {
  return to_eigen(numbers_->element.force_increment(corners_of(dx)));
}

ElementPoints Element::mean_gradient() const { return to_eigen(numbers_->element.sample_gradients().mean); }
std::array<ElementPoints, kCorners> Element::sample_gradients() const {
  std::array<ElementPoints, kCorners> found;
  for (int a = 0; a < kCorners; ++a) {
    scalar::CornerLanes<double> moved;  // corner a along x
    set_zero(moved);
    moved.at[a][0] = 1;
    scalar::Mat<double> F[kCorners];
    numbers_->element.sample_gradients().gradients(moved, F);
    for (int i = 0; i < kCorners; ++i) found[i].row(a) << F[i](0, 0), F[i](0, 1), F[i](0, 2);
  }
  return found;
}

ElementStep flow_element(const Model& model, int e, const ElementPoints& plastic_rest, const ElementPoints& current,
                         const Mat3& frame, const ElementHistory& before, double dt) {
  scalar::Element<double> element;
  set(plastic_rest, current, model.lame[e], model.settings, nullptr, {}, element);
  const scalar::InitialElement<double> initial = [&] {
    scalar::InitialElement<double> of;
    of.shape = corners_of(model.initial_shape(e));
    std::ranges::copy(model.corner_jacobian(e), of.jacobian);
    of.volume = model.volume[e];
    return of;
  }();
  const Material& material = model.material(e);
  const scalar::FlowRule<double> rule{.rate_dt = can_stretch(material) ? material.flow_rate * dt : 0,
                                      .rotation_rate_dt = material.rotation_flow_rate * dt,
                                      .hardening = material.hardening,
                                      .stretches = model.can_stretch,
                                      .rotates = model.can_rotate,
                                      .dt = dt};
  scalar::JoinedHistory<double> history = numbers_of(before);
  scalar::JoinedFlow<double> flow;
  scalar::flow_element(element, corners_of(plastic_rest), corners_of(current), initial, model.settings,
                       model.tracks_plastic_stretch, rule, scalar::entries(frame), history, flow);
  ElementStep step;
  step.inverted = flow.inverted != 0;
  step.skipped = flow.skipped != 0;
  step.repaired = flow.repaired != 0;
  step.yielded = flow.yielded != 0;
  step.volume_ratio = flow.volume_ratio;
  step.dissipated = flow.dissipated;
  for (int i = 0; i < kCorners; ++i) {
    step.stretch_fraction[i] = flow.fraction[i];
    step.rotation_fraction[i] = flow.rotation_fraction[i];
    step.stretch[i] = scalar::to_eigen(flow.stretch[i]) + Mat3::Identity();
    step.rotation[i] = scalar::to_eigen(flow.rotation[i]) + Mat3::Identity();
  }
  step.next = before;
  take(history, step.next);
  return step;
}

ElementOutcome flow_alone(const Model& model, ConstPoints x, double dt, const Mat3* frame, const History& before,
                          int element, History& next) {
  const Hexahedron& corners = model.mesh.hexahedra()[element];
  const ElementStep step =
      flow_element(model, element, gather(before.plastic_rest_positions, corners), gather(x, corners),
                   frame ? *frame : Mat3(Mat3::Identity()), before.element(model, element), dt);
  next.set_element(element, step.next);
  return {.yielded = step.yielded,
          .inverted = step.inverted,
          .skipped = step.skipped,
          .repaired = step.repaired,
          .volume_error = std::abs(step.volume_ratio - 1),
          .dissipated = step.dissipated};
}

}  // namespace hexaplast::plain
