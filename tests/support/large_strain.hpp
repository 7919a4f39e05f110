// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/material/material.hpp"

/// The bodies that CalculiX has strained far (tests/data/calculix/hyperelastic.json), E = 5000 Pa.
namespace hexaplast::support {

struct Strained {
  double force = 0;  ///< [-] over Young's modulus and the original area
  double volume_ratio = 1;
};

/// One cube stretched along x, free to contract.
Strained uniaxial(double poisson_ratio, double stretch, const Settings& settings);

/// [-] Nominal stress over the shear modulus of one cube in simple shear, x += shear z.
double shear_stress(double poisson_ratio, double shear, const Settings& settings);

/// 4 x 4 x 4 cubes, two opposite faces held in their planes and moved apart. Throws std::runtime_error where no
/// equilibrium is found, as does the next.
Strained held_block(double poisson_ratio, double stretch, const Settings& settings);

/// [-] Mean deflection over length of the tip of a clamped beam of 1 x 0.1 x 0.1 m, `across` cubes thick, under a dead
/// force [N] even over its end.
double large_deflection(double poisson_ratio, int across, double force, const Settings& settings);

}  // namespace hexaplast::support
