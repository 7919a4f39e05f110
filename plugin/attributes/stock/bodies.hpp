// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// SOFA's elastic bodies. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kHexahedronFEMAttributes[] = {
    {.name = "youngModulus",
     .type = Type::kReals,
     .initial = "5000",
     .unit = "Pa",
     .range = kPositive,
     .help = "Young's modulus: one value, or one per hexahedron."},
    {.name = "poissonRatio",
     .type = Type::kReals,
     .initial = "0.45",
     .range = {.least = 0, .most = 0.5, .without_most = true},
     .help = "Poisson's ratio: one value, or one per hexahedron."},
    {.name = "method",
     .type = Type::kWord,
     .initial = "large",
     .words = "large polar small",
     .help =
         "Accepted, and the same here for all three: rotations are taken out at eight points of each hexahedron, and "
         "not once for the whole of it as in SOFA (in small not at all)."},
    {.name = "updateStiffnessMatrix",
     .type = Type::kWord,
     .initial = "false",
     .words = "false 0",
     .help = "Only false here: the stiffness is that of the rest shape."},
    {.name = "rayleighStiffness",
     .type = Type::kReal,
     .initial = "0",
     .unit = "s",
     .range = kNotNegative,
     .help = "Stiffness-proportional damping of this body in the system matrix alone, besides the solver's own."},
    {.name = "topology",
     .type = Type::kLink,
     .help = "The hexahedra; the topology of the node (or of the nearest one above) where it is not given."},
    ignored_attribute("gatherPt", "Ignored here: for graphics processors."),
    ignored_attribute("gatherBsize", "Ignored here: for graphics processors."),
    visual_attribute("drawing"),
    visual_attribute("drawPercentageOffset"),
};
inline constexpr Description kHexahedronFEMForceField{
    .class_name = "HexahedronFEMForceField",
    .category = "ForceField",
    .help =
        "SOFA's elastic hexahedra, computed by the elements of HexahedronElastoplasticFEMForceField without yield: "
        "equal for small strains without bending within a hexahedron, softer in bending, with another rotation where "
        "a hexahedron twists.",
    .templates = kVec3Templates,
    .attributes = kHexahedronFEMAttributes};

}  // namespace hexaplast::attributes
