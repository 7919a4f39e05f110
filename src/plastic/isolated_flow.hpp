// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "element/samples.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// Size of a stress [Pa] in the given norm.                                                   theory.md eq. 20
double stress_norm(const Mat3& sigma, YieldNorm norm);

/// What yields at the samples of a hexahedron with isolated rest shapes.                         theory.md section 5.9
struct IsolatedStress {
  CornerTensors normals;    ///< rows n_in                                                                    eq. P6
  CornerTensors corotated;  ///< [Pa] sigma_i without the pressure of the volume ratio                        eq. P7
  CornerTensors whole;      ///< [Pa] sigma_i, or true stress                                            eq. P7, P7t
  CornerTensors relieved;   ///< [Pa] of it, what yields                                                      eq. P8
};

/// initial: corners [m]; samples: of F^e, with the stress of all pressures.
IsolatedStress isolated_stress(const ElementPoints& initial, const CornerTensors& plastic_inverse,
                               const ElementSamples& samples, YieldStressMeasure measure);

/// One plastic step of the same.                                                                 theory.md section 5.9
struct IsolatedStep {
  bool yielded = false;
  bool inverted = false;           ///< at some sample, det F^e < 0
  bool skipped = false;            ///< without flow: a sample is inverted or nearly so
  CornerValues norm = {};          ///< [Pa] of the stress that yields                                         eq. P8
  CornerValues fraction = {};      ///< gamma                                                                  eq. P9
  CornerValues strain = {};        ///< [-] accumulated in the step: sqrt(2/3) |dev M|_F
  CornerTensors log_stretch;       ///< M: logarithm of S^p                                                   eq. P11
  CornerTensors plastic_inverse;   ///< G after the step                                                      eq. P12
  CornerValues yield_stress = {};  ///< [Pa] tau after the step                                               eq. P12
  double dissipated = 0;           ///< [J]
};

/// yield_stress [Pa]: tau before the step; mu [Pa]; dt [s].
IsolatedStep isolated_flow(const ElementSamples& samples, const IsolatedStress& stress,
                           const CornerTensors& plastic_inverse, double mu, const Material& material, YieldNorm norm,
                           const CornerValues& yield_stress, double dt);

/// The same of an element of a body, without flow where it is nearly inverted. Elastic elements may have a joined rest
/// shape.
IsolatedStep isolated_step(const Model& model, int element, const ElementSamples& samples, const History& history,
                           double dt);

/// Takes the step of an element over into a history that has what was before it.
void set_isolated(int element, const IsolatedStep& step, History& history);

/// Takes the branches of an element over the step. Returns what they dissipate [J].                     eq. P13, P19
double relax(int element, const ElementSamples& samples, const Lame& lame, const Branches& branches, History& history);

/// Stretch that has flowed leaves the branches too. flowed: samples after the flow.                           eq. P16
void relieve_branches(int element, const ElementSamples& flowed, History& history);

}  // namespace hexaplast
