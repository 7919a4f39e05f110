// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// States that follow others. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMappingInput =
    link("input", "The state that is followed, or its node; default: the nearest one above this node.");
inline constexpr Attribute kMappingOutput =
    link("output", "The mapped state, or its node; default: that of this node.");

inline constexpr std::array kBarycentricMappingAttributes = {
    kMappingInput,
    kMappingOutput,
    boolean("useRestPosition", {.initial = "false"},
            "true: points are located in the rest positions; otherwise in the first positions."),
    link("input_topology", "The hexahedra; default: the topology of the followed state's node."),
    ignored_attribute("output_topology", "Ignored here: points are not removed."),
    ignored_attribute("mapForces", "Ignored here: forces are always carried up."),
    ignored_attribute("mapMasses", "Ignored here: masses are always carried up."),
    ignored_attribute("mapConstraints", "Ignored here: there are no Lagrangian constraints."),
};
inline constexpr Description kBarycentricMapping = mapping(
    "BarycentricMapping",
    "Points that move with the hexahedra they lie in, at their trilinear coordinates. SOFA's are affine: in hexahedra "
    "that are no boxes points jump at the beginning. Points outside follow the nearest hexahedron's motion to first "
    "order; a message gives their number. Forces and stiffness on points act on the hexahedra, with the same force and "
    "moment. Where hexahedra are removed, cells of the points in them count as removed; the points follow the nodes.",
    kBarycentricMappingAttributes);

inline constexpr std::array kIdentityMappingAttributes = {
    kMappingInput,
    kMappingOutput,
    ignored_attribute("mapForces", "Ignored here: forces are always carried up."),
    ignored_attribute("mapMasses", "Ignored here: masses are always carried up."),
    ignored_attribute("mapConstraints", "Ignored here: there are no Lagrangian constraints."),
};
inline constexpr Description kIdentityMapping =
    mapping("IdentityMapping", "A state with the same nodes as the one it follows.", kIdentityMappingAttributes);

}  // namespace hexaplast::attributes
