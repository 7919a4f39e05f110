// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/rows.hpp"
#include "attributes/stock/ignored.hpp"

/// SOFA's elastic bodies. See stock.hpp.
namespace hexaplast::attributes {

inline const std::vector<Attribute> kHexahedronFEMAttributes = {
    body_attribute("youngModulus"),
    body_attribute("poissonRatio"),
    {.name = "method",
     .type = Type::kWord,
     .initial = "large",
     .words = "large polar small",
     .help = "Accepted, and the same here for all three: rotations are removed at eight points of each hexahedron, and "
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
     .help = "The hexahedra; default: the topology of the node, or of the nearest one above."},
    ignored_attribute("gatherPt", "Ignored here: for graphics processors."),
    ignored_attribute("gatherBsize", "Ignored here: for graphics processors."),
    visual_attribute("drawing"),
    visual_attribute("drawPercentageOffset"),
};
inline const Description kHexahedronFEMForceField{
    .class_name = "HexahedronFEMForceField",
    .category = "ForceField",
    .help =
        "SOFA's elastic hexahedra, computed by the elements of HexahedronElastoplasticFEMForceField without yield: "
        "equal for small strains without bending within a hexahedron, softer in bending, with another rotation where "
        "a hexahedron twists.",
    .templates = kVec3Templates,
    .attributes = kHexahedronFEMAttributes};

}  // namespace hexaplast::attributes
