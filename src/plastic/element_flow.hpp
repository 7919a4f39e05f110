// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>

#include "element/samples.hpp"
#include "plastic/point_flow.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// What a plastic step finds of one element; all references must outlive the call.
struct FlowInput {
  const Material& material;
  const Settings& settings;
  ElementPoints initial_shape;   ///< [m] corners of the initial mesh about their mean
  CornerValues corner_jacobian;  ///< [m^3] det J_i of the initial mesh
  double initial_volume;         ///< [m^3] V0
  const ElementPoints& x;        ///< [m] plastic rest corners
  const ElementSamples& samples;
  const ElementPoints& current;  ///< [m] current corners
  const Mat3& frame;             ///< B: what the paper's rotation modes are measured against
  bool tracks_stretch = false;   ///< Model::tracks_plastic_stretch
};

/// One plastic step of one element, with every intermediate.                        theory.md sections 5.1 to 5.4
struct ElementStep {
  bool inverted = false;             ///< inverted at some corner (det F~ < 0)
  bool skipped = false;              ///< without flow: inverted or nearly so
  bool repaired = false;             ///< the plastic rest shape was moved towards the initial one
  bool yielded = false;              ///< stretch or rotation flowed at some corner
  Mat3 R_centre = Mat3::Identity();  ///< R_o; set where rotation can flow
  std::array<StretchFlow, kCorners> stretch;
  std::array<RotationFlow, kCorners> rotation;
  double volume_ratio = 1;  ///< beta [-]
  double dissipated = 0;    ///< [J]
  ElementHistory next;      ///< the element's history after the step, before the averaging
};

ElementStep flow_element(const FlowInput& at, const ElementHistory& before, double dt);

/// Smallest det J_i(x) / det J_i(X) of an element's corners.
double min_jacobian_ratio(const CornerValues& initial, const ElementPoints& x);

inline constexpr double kCollapsedJacobian = 0.02;  ///< of the original: averaging may not press a corner below

/// Whether a step has carried an element past its limits at some corner: its yield stress by hardening, or its plastic
/// stretch (null where the model does not track it). A yield stress that lies beyond the limit without having grown
/// there breaks nothing: an element without one, for which it is infinite, may still flow by rotation.
bool is_broken(const Material& material, const CornerValues& yield_stress_before, const CornerValues& yield_stress,
               const CornerTensors* plastic_stretch);
/// The same of an element that has flowed from one history to the next.
bool is_broken(const Model& model, const History& before, const History& next, int element);

}  // namespace hexaplast
