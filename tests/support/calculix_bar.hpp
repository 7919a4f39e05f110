// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/solve/newton_raphson.hpp"
#include "support/golden.hpp"
#include "support/simulation.hpp"

/// The bar that CalculiX has solved (tests/data/calculix): 0.03 x 0.03 x 0.1 m of cubes, held in its middle plane,
/// loaded at both ends by dead forces, equal and opposite.
namespace hexaplast::support {

/// How the load is spread over each end. Forces go to the nodes by the area that belongs to them.
enum class EndLoad {
  kCentralStretch,  ///< `force` [N] along the axis on the central ninth of the end
  kFaceStretch,     ///< `force` [N] along the axis on the whole end
  kFaceTwist        ///< torque 2 `force` 0.01 m about the axis: nodal forces (-y, x) times the area
};

/// The load over time: grows to its full size until `ramp` [s], is held until `hold`, gone at `release`, the run ends
/// at `end`.
struct Schedule {
  double ramp = 1, hold = 5, release = 6, end = 8;
  double weight(double time) const;
};

struct BarCase {
  Material material;
  Settings settings = published_element();
  EndLoad load = EndLoad::kCentralStretch;
  double force = 0;
  Schedule schedule = {};
  double dt = 0.04;  ///< [s]
  int refine = 1;    ///< cubes of 0.01 m / refine
};

/// The bar at one moment.
struct BarState {
  double central_elongation = 0;  ///< [-] between the nodes of the central ninth of both ends
  double mean_elongation = 0;     ///< [-] between all nodes of both ends
  double volume_ratio = 1;        ///< of the world mesh
  std::vector<double> twist_deg;  ///< of each layer of nodes, from the lower end upwards: mean turn of the corners
                                  ///< of the section and of its central ninth
};

struct BarRun {
  BarState peak;      ///< when the load ends to be held
  BarState residual;  ///< at the end
  int unsolved = 0;   ///< steps in which no equilibrium was found
};

/// E = 5000 Pa, Poisson's ratio 0.45, hardening 0.2.
Material calculix_material(double yield_stress, double flow_rate);

/// Quasi-static: per time step equilibrium under the load of that time, then plastic flow.
BarRun run_bar(const BarCase& bar);

/// The first row of a list of tests/data/calculix that has all that is wanted.
Json row_of(const Json& rows, const Json& wanted);

/// BarState::twist_deg of a layer in a state of those rows.
double twist_deg(const Json& state, std::size_t layer);

/// Equilibrium of an elastic body under dead nodal loads [N], in `load_steps` equal steps. Throws std::runtime_error
/// where none is found.
PointArray elastic_equilibrium(Body& body, const std::vector<int>& fixed, const PointArray& loads, int load_steps);

/// The fraction of every node in a force spread evenly over those boundary faces whose nodes all belong to `nodes`.
std::vector<double> face_weights(const HexMesh& mesh, const std::vector<int>& nodes);

}  // namespace hexaplast::support
