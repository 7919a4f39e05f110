// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// States that follow others. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kMappingInput{
    .name = "input",
    .type = Type::kLink,
    .help = "The state that is followed, or its node; default: the nearest one above this node."};
inline constexpr Attribute kMappingOutput{
    .name = "output", .type = Type::kLink, .help = "The mapped state, or its node; default: that of this node."};

inline constexpr Attribute kBarycentricMappingAttributes[] = {
    kMappingInput,
    kMappingOutput,
    {.name = "useRestPosition",
     .type = Type::kBool,
     .initial = "false",
     .help = "true: points are located in the rest positions; otherwise in the first positions."},
    {.name = "input_topology",
     .type = Type::kLink,
     .help = "The hexahedra; default: the topology of the followed state's node."},
    ignored_attribute("output_topology", "Ignored here: points are not removed."),
    ignored_attribute("mapForces", "Ignored here: forces are always carried up."),
    ignored_attribute("mapMasses", "Ignored here: masses are always carried up."),
    ignored_attribute("mapConstraints", "Ignored here: there are no Lagrangian constraints."),
};
inline constexpr Description kBarycentricMapping{
    .class_name = "BarycentricMapping",
    .category = "Mapping",
    .help =
        "Points that move with the hexahedra they lie in, at their trilinear coordinates. SOFA's are affine: in "
        "hexahedra that are no boxes points jump at the beginning. Points outside follow the nearest hexahedron's "
        "motion to first order; a message gives their number. Forces and stiffness on points act on the hexahedra, "
        "with the same force and moment. Where hexahedra are removed, cells of the points in them count as removed; "
        "the points follow the nodes.",
    .templates = "Vec3,Vec3 Vec3d,Vec3d",
    .attributes = kBarycentricMappingAttributes};

inline constexpr Attribute kIdentityMappingAttributes[] = {
    kMappingInput,
    kMappingOutput,
    ignored_attribute("mapForces", "Ignored here: forces are always carried up."),
    ignored_attribute("mapMasses", "Ignored here: masses are always carried up."),
    ignored_attribute("mapConstraints", "Ignored here: there are no Lagrangian constraints."),
};
inline constexpr Description kIdentityMapping{.class_name = "IdentityMapping",
                                              .category = "Mapping",
                                              .help = "A state with the same nodes as the one it follows.",
                                              .templates = "Vec3,Vec3 Vec3d,Vec3d",
                                              .attributes = kIdentityMappingAttributes};

}  // namespace hexaplast::attributes
