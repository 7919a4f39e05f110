// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <functional>
#include <vector>

#include "hexaplast/material/material.hpp"
#include "state/history.hpp"

namespace hexaplast {

/// One hexahedron looked at by itself: every intermediate of its elasticity and of one plastic step, by the names of
/// theory.md. Meant for understanding and tuning a material; a Body computes the same for a mesh, and keeps less.

/// A hexahedron in any state. All positions [m], corners as rows.
struct HexahedronState {
  ElementPoints initial;       ///< X
  ElementPoints plastic_rest;  ///< x
  ElementPoints current;       ///< xh
  ElementHistory history;      ///< isolated rest shape, rotation maps, thresholds; of isolated rest shapes G
};

/// The initial state: plastic rest and current positions are the initial ones.
HexahedronState initial_hexahedron(const ElementPoints& initial, const Material& material);

struct HexahedronElasticity {
  CornerTensors corner_jacobian;                        ///< [m] J_i of the plastic rest shape                    eq. 2
  Mat3 centre_jacobian;                                 ///< [m] J_o                                          eq. 3
  double volume;                                        ///< [m^3] of the plastic rest shape                      eq. 4
  double sample_volume;                                 ///< [m^3] that each sample carries
  ElementPoints mean_gradient;                          ///< [1/m] Gm                                         eq. 9
  std::array<ElementPoints, kCorners> sample_gradient;  ///< [1/m] g~, per sample                             eq. 7
  double energy;                                        ///< [J]                                              eq. 18
  ElementPoints force;                                  ///< [N]                                              eq. 15
  Eigen::Matrix<double, 24, 24> stiffness;              ///< [N/m] -df/dx, row 3a + axis; rotations fixed      eq. 17
};

/// Throws InputError for a material or settings outside their ranges, or an initial shape that is inverted.
HexahedronElasticity inspect_elasticity(const HexahedronState& state, const Material& material,
                                        const Settings& settings);

struct HexahedronStep {
  CornerTensors F_corner;   ///< F_i                                                                          eq. 1
  Mat3 F_centre;            ///< F_o                                                                          eq. 1
  CornerTensors F_blended;  ///< (F_i + F_o) / 2
  CornerTensors F;     ///< F~, the gradient of the chosen scheme, of isolated rest shapes F^e                eq. 7, P1
  CornerTensors R, S;  ///< of F~                                                                        eq. 6
  Mat3 R_centre;       ///< R_o
  CornerTensors Q;     ///< R_o^T R_i
  CornerValues phi;    ///< [rad]; in the centre mode the maximum of the corners                        eq. 24
  CornerTensors strain;      ///< S - I
  CornerTensors stress;      ///< [Pa] sigma; of isolated rest shapes without what is relieved             eq. 12, P8
  CornerValues stress_norm;  ///< [Pa]                                                              eq. 20
  CornerValues stretch_flow_fraction;   ///< gamma                                                             eq. 21
  CornerTensors stretch_increment;      ///< S^p                                                               eq. 22
  CornerValues rotation_flow_fraction;  ///< eta                                                           eq. 25, 33
  CornerTensors rotation_increment;     ///< R^p                                                           eq. 26, 34
  double volume_ratio;                  ///< beta = plastic / initial volume
  bool skipped;                         ///< without flow: inverted or nearly so
  ElementHistory history;               ///< after the step
  double rest_volume;                   ///< [m^3] of the rest shape after the step
  ElementPoints plastic_rest;           ///< [m] x after the step                                              eq. 31
  double plastic_volume;                ///< [m^3] of it
};

/// One plastic step over dt [s], averaging included; what does not flow in the chosen mode is identity or 0. Throws
/// InputError as inspect_elasticity does, and where nu dt, nu^R dt or c dt passes its limit.
HexahedronStep inspect_step(const HexahedronState& state, const Material& material, const Settings& settings, double dt,
                            Names names = Names::kMembers);

/// A deformation gradient of the whole hexahedron, relative to its initial shape.
struct PathPoint {
  double time;  ///< [s]
  Mat3 F;
};

/// What a hexahedron answers at one moment of a path.
struct PathResponse {
  double time;               ///< [s]
  Mat3 F;                    ///< imposed
  Mat3 P;                    ///< [Pa] mean first Piola stress with respect to the initial shape
  double stress_norm;        ///< [Pa] maximum of the corners
  double plastic_strain;     ///< mean of the corners, accumulated
  double yield_stress;       ///< [Pa] maximum of the corners
  double volume_ratio;       ///< plastic / initial volume
  double energy;             ///< [J] elastic
  double dissipated_energy;  ///< [J] accumulated
};

/// Deforms an initial hexahedron along F(t), linear between the points, in steps of at most dt [s] with a plastic step
/// after each, and hands every moment to `report`. Throws as inspect_step does, and InputError where the path is empty
/// or its times do not ascend.
void follow_path(const ElementPoints& initial, const Material& material, const Settings& settings, double dt,
                 const std::vector<PathPoint>& path, const std::function<void(const PathResponse&)>& report,
                 Names names = Names::kMembers);

}  // namespace hexaplast
