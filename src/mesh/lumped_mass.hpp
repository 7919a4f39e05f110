// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>
#include <vector>

#include "hexaplast/base/types.hpp"

namespace hexaplast {

/// Each of these throws InputError for arguments of different sizes and for corners that are not there.

/// Volume [m^3] of a hexahedron cut into six tetrahedra around the diagonal from corner 0 to corner 6, each counted
/// positive: the volume that SOFA's masses are made of. Equal to the trilinear volume where the faces are plane.
double six_tetrahedra_volume(const ElementPoints& corners);

/// The same of each hexahedron. x: num_nodes x 3 [m]; the corners must be rows of x.
std::vector<double> element_volumes(ConstPoints x, std::span<const Hexahedron> hexahedra);

/// Fraction of the volume [m^3] that belongs to each node: every hexahedron gives an eighth to each of its corners.
/// Times the density these are the lumped masses. x: num_nodes x 3 [m]; the corners must be rows of x.
Eigen::VectorXd nodal_volumes(ConstPoints x, std::span<const Hexahedron> hexahedra);

/// Masses [kg] of the nodes, of which each hexahedron gives an eighth of its own to each of its corners.
Eigen::VectorXd nodal_masses(int num_nodes, std::span<const Hexahedron> hexahedra, std::span<const double> masses);

/// f += m g per node. masses: num_nodes [kg], gravity [m/s^2].
void add_gravity(const Eigen::VectorXd& masses, const Vec3& gravity, Points f);

/// sum m |v|^2 / 2 [J].
double kinetic_energy(const Eigen::VectorXd& masses, ConstPoints v);

}  // namespace hexaplast
