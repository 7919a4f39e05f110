// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/body.hpp"

/// One value per hexahedron, each without the decompositions that Body::fields needs: in a time that does not count
/// beside a step.
namespace hexaplast {

/// [-] ElementFields::plastic_strain.
std::vector<double> plastic_strains(const Body& body);

/// [Pa] ElementFields::yield_stress.
std::vector<double> present_yield_stresses(const Body& body);

/// [m^3] at any nodal positions (num_nodes x 3): the current ones, or body.plastic_rest_positions(). 0 for those that
/// are removed. Throws InputError for positions of another number of nodes.
std::vector<double> element_volumes(const Body& body, ConstPoints x);

/// [-] ElementFields::volume_ratio, up to rounding: volume at the plastic rest positions over the initial one.
std::vector<double> plastic_volume_ratios(const Body& body);

}  // namespace hexaplast
