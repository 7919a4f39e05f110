// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hexaplast/geometry/cut_surface.hpp"
#include "picture/boundary_conditions.hpp"
#include "picture/quantity.hpp"
#include "record/measures.hpp"

namespace hexaplast::view {

using output::Quantity;

/// How fast the simulation goes on.
enum class Pace {
  kRealTime,  ///< as the clock on the wall, or slower where a step takes longer than it lasts
  kFree       ///< as fast as it can
};

/// Numbers that are plotted, of one moment.
struct Sample {
  double time = 0;  ///< [s]
  output::Measures measures;
  double greatest_plastic_strain = 0;  ///< [-] of a hexahedron
  double kinetic_energy = 0;           ///< [J]
  double elastic_energy = 0;           ///< [J]
  double dissipated_energy = 0;        ///< [J]
  std::vector<double> probes = {};     ///< of the latest step; empty: there was none yet
};

/// The simulation as it was between two steps. Nodal arrays have num_nodes rows, of several bodies those of one behind
/// those of another.
struct Snapshot {
  long step = 0;
  bool is_running = false;
  bool is_late = false;                        ///< steps take longer than the pace asks for
  std::string failure;                         ///< why it cannot go on before a reset; empty: it can
  std::vector<std::string> messages;           ///< that came since the last snapshot
  std::shared_ptr<const HexMesh> mesh = {};    ///< the present one, the same until nodes split
  std::shared_ptr<const OpenFaces> open = {};  ///< faces between hexahedra of the mesh; null: none
  PointArray positions;                        ///< [m]
  PointArray plastic_rest;                     ///< [m] what the body would be without forces
  std::vector<unsigned char> alive;            ///< per hexahedron
  Quantity quantity = Quantity::kPlasticStrain;
  std::vector<double> values;        ///< of the quantity, per node; infinite for the yield stress of what never yields
  std::vector<double> of_hexahedra;  ///< the same per hexahedron; of the speed: empty
  std::vector<std::optional<double>> parameter_values;  ///< of each parameter, as it is now; none: not given
  std::vector<int> held;                                ///< nodes in the hand
  Vec3 hand_force = Vec3::Zero();                       ///< [N] of the hand on the bodies, in the latest step
  output::BoundaryConditions conditions;                ///< loads, instruments, what is fixed
  int num_undo = 0;                                     ///< holds of the hand that can be taken back
  Sample sample;
  std::vector<float> step_ms;  ///< wall time of each step since the last snapshot
};

}  // namespace hexaplast::view
