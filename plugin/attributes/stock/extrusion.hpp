// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Hexahedra grown from a surface. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kExtrudeQuadsAndGenerateHexasAttributes[] = {
    {.name = "surfaceVertices", .type = Type::kVectors3, .unit = "m", .help = "Vertices of the surface."},
    {.name = "surfaceQuads",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Groups of four vertices, counter-clockwise seen from the side of the normals. They must form an oriented "
             "manifold, open or closed, and every vertex must belong to one."},
    {.name = "scale",
     .type = Type::kVector3,
     .initial = "1 1 1",
     .help = "Applied first to the vertices; the thickness is that of the scaled surface. SOFA takes the normals of "
             "the surface before."},
    {.name = "thicknessIn",
     .type = Type::kReal,
     .initial = "0",
     .unit = "m",
     .help = "Distance of the inner side from the surface, against the normals; negative: along them."},
    {.name = "thicknessOut",
     .type = Type::kReal,
     .initial = "1",
     .unit = "m",
     .help = "Distance of the outer side from the surface, along the normals; negative: against them."},
    {.name = "numberOfSlices",
     .type = Type::kInteger,
     .initial = "1",
     .range = {.min = 1, .max = 1000000},
     .help = "Hexahedra across the thickness."},
    {.name = "extrudedVertices",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Nodes: numberOfSlices + 1 for each vertex, from the inner side outward."},
    {.name = "extrudedSurfaceQuads",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "The given quads at the inner side: groups of four nodes."},
    {.name = "extrudedQuads",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "All faces of the hexahedra, each once: groups of four nodes. SOFA repeats those that hexahedra share."},
    {.name = "extrudedHexas",
     .type = Type::kHexahedra,
     .access = Access::kOutput,
     .help = "Hexahedra: numberOfSlices for each quad, from the inner side outward."},
    ignored_attribute("flipNormals",
                      "Ignored here: in SOFA it inverts hexahedra; here all have the correct orientation."),
    visual_attribute("isVisible"),
};
inline constexpr Description kExtrudeQuadsAndGenerateHexas{
    .class_name = "ExtrudeQuadsAndGenerateHexas",
    .category = "Engine",
    .help =
        "Grows hexahedra from a surface of quads. The thickness is measured normal to the quads, so that vertices on "
        "edges and corners move further (SOFA moves every vertex by the thickness itself); a surface that is no "
        "manifold, or that folds because it bends more sharply than the thickness allows, is refused.",
    .templates = kVec3Templates,
    .attributes = kExtrudeQuadsAndGenerateHexasAttributes};

}  // namespace hexaplast::attributes
