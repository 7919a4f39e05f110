// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <vector>

#include "hexaplast/material/material.hpp"

/// Ideal plastic bodies of the default element beyond yield, in static equilibrium, whose answers are known from beam
/// theory, from the theory of tubes, or from CalculiX (tests/data/calculix/beyond_yield.json).
namespace hexaplast::support {

/// 0.2 x 0.01 x 0.02 m, clamped, E = 2.1 MPa, yield stress 2350 Pa; a dead force, equal at all nodes of the end.
struct Cantilever {
  std::array<int, 3> cells;
  double load;  ///< [-] over that of first yield of a beam
  double poisson_ratio = 0;
  RestShape rest_shape = RestShape::kIsolated;
  double time = 100;  ///< [1/nu] under the load
};

struct BentCantilever {
  double loaded = 0, released = 0;  ///< [m] mean deflection of the end under the load and after it
  double creep = 0;                 ///< [-] growth of the first in the 1/nu after `time`
  double residual_energy = 0;       ///< [J] without load
};
BentCantilever bend(const Cantilever& beam);

/// The same of Bernoulli's beam, for poisson_ratio 0.
BentCantilever bend_in_theory(const Cantilever& beam);

/// [-] Moment of a strip in pure bending at 20 times the curvature of first yield, over the limit moment. is_plate: as
/// wide as high, and nothing moves along the axis of bending.
double limit_moment(int cells_across, bool is_plate, double poisson_ratio);

/// [-] The limit moment over that of first yield in uniaxial stress.
double exact_limit_moment(bool is_plate);

/// [-] Moments of a strip bent to three times the curvature of first yield, and as far back, after each tenth of that
/// curvature, over that of first yield.
std::vector<double> bend_to_and_fro(int cells_across);

/// What such moments tell. Curvatures are over that of first yield.
struct BendingLoop {
  double residual_curvature = 0;  ///< where the moment has gone; exact 14/9
  double reversed_moment = 0;     ///< at the curvature .9 on the way back; exact -.6486
  double rms = 0;                 ///< of the difference from the beam's moment
};
BendingLoop loop_of(const std::vector<double>& moments);

/// A quarter of a tube of radii 1 and 2, in plane strain, nu_P = .49, under the pressure that makes it plastic up to
/// the radius 1.5, and without it.
struct ExpandedTube {
  double outer_displacement = 0;  ///< [m] under pressure
  std::vector<double> hoop;       ///< [-] residual stress over the yield stress, mean of each ring of cells
};
ExpandedTube expand_tube(int cells_across);
ExpandedTube tube_in_theory(int cells_across);

/// Root of the mean square of the difference.
double rms(const std::vector<double>& found, const std::vector<double>& expected);

/// [-] Force over yield stress and original area of 3 x 3 x 4 cubes, E = 5000 Pa, nu_P = .45, yield stress 50 Pa (true
/// stress), whose ends are held and moved apart, with plastic steps of rate 1 after each move, at the
/// stretches 1.1, 1.2 and 1.3.
std::array<double, 3> stretch_block(int moves_per_percent, int flows_per_move);

/// 20 x 20 mm of the upper face of a block of 60 x 60 x 30 mm that are moved up, every 2 mm up to a height [m]. The
/// lower face is held; E = 2 kPa, nu_P = .45, yield stress 160 Pa (true stress).
struct PulledPatch {
  double force = 0;         ///< [N]
  double least_corner = 1;  ///< [-] Jacobian of a corner over that at rest
};
std::vector<PulledPatch> pull_patch(double edge, double height, RecoveryMode recovery = RecoveryMode::kCluster);

}  // namespace hexaplast::support
