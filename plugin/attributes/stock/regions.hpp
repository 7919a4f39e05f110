// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Parts of a body found by their place. See stock.hpp.
namespace hexaplast::attributes {

/// What every region takes and gives.
inline constexpr Attribute kRegionAttributes[] = {
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Points to select from; default: the rest positions of the nearest state."},
    {.name = "edges",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Edges to select from; default: those of the nearest topology."},
    {.name = "triangles",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Triangles to select from; default: those of the nearest topology."},
    {.name = "quads",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Quads to select from; default: those of the nearest topology."},
    {.name = "hexahedra",
     .type = Type::kHexahedra,
     .range = kIndex,
     .help = "Hexahedra to select from; default: those of the nearest topology."},
    {.name = "strict",
     .type = Type::kBool,
     .initial = "true",
     .help = "A cell is inside when all its nodes are; otherwise when its centre is."},
    {.name = "indices", .type = Type::kIntegers, .access = Access::kOutput, .help = "Points inside, ascending."},
    {.name = "indicesOut", .type = Type::kIntegers, .access = Access::kOutput, .help = "Points outside, ascending."},
    {.name = "nbIndices", .type = Type::kInteger, .access = Access::kOutput, .help = "How many points are inside."},
    {.name = "pointsInROI",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Their positions."},
    {.name = "edgeIndices", .type = Type::kIntegers, .access = Access::kOutput, .help = "Edges inside, ascending."},
    {.name = "triangleIndices",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "Triangles inside, ascending."},
    {.name = "quadIndices", .type = Type::kIntegers, .access = Access::kOutput, .help = "Quads inside, ascending."},
    {.name = "hexahedronIndices",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "Hexahedra inside, ascending."},
    {.name = "edgesInROI", .type = Type::kIntegers, .access = Access::kOutput, .help = "Nodes of the edges inside."},
    {.name = "trianglesInROI",
     .type = Type::kIntegers,
     .access = Access::kOutput,
     .help = "Nodes of the triangles inside."},
    {.name = "quadsInROI", .type = Type::kIntegers, .access = Access::kOutput, .help = "Nodes of the quads inside."},
    {.name = "hexahedraInROI",
     .type = Type::kHexahedra,
     .access = Access::kOutput,
     .help = "Nodes of the hexahedra inside."},
    ignored_attribute("doUpdate", "Ignored here: outputs follow their inputs."),
    ignored_attribute("computeEdges", "Ignored here: what is asked for is computed."),
    ignored_attribute("computeTriangles", "Ignored here: what is asked for is computed."),
    ignored_attribute("computeQuads", "Ignored here: what is asked for is computed."),
    ignored_attribute("computeTetrahedra", "Ignored here: there are none."),
    ignored_attribute("computeHexahedra", "Ignored here: what is asked for is computed."),
    visual_attribute("drawROI"),
    visual_attribute("drawPoints"),
    visual_attribute("drawEdges"),
    visual_attribute("drawTriangles"),
    visual_attribute("drawQuads"),
    visual_attribute("drawTetrahedra"),
    visual_attribute("drawHexahedra"),
    visual_attribute("drawSize"),
};

inline constexpr Attribute kBoxes[] = {
    {.name = "box",
     .type = Type::kBoxes,
     .initial = "0 0 0 1 1 1",
     .unit = "m",
     .help = "Two opposite corners of each box, in any order. Points on the border are inside. The default is ignored "
             "if an orientedBox is given."},
    {.name = "orientedBox",
     .type = Type::kReals,
     .unit = "m",
     .help = "Ten numbers for each box: three consecutive corners of a rectangle, and the thickness, half of it to "
             "either side."},
    visual_attribute("drawBoxes"),
};
inline constexpr auto kBoxROIAttributes = joined(kBoxes, kRegionAttributes);
inline constexpr Description kBoxROI{.class_name = "BoxROI",
                                     .category = "Engine",
                                     .help = "Finds what lies in boxes.",
                                     .templates = kVec3Templates,
                                     .attributes = kBoxROIAttributes};

inline constexpr Attribute kSpheres[] = {
    {.name = "centers", .type = Type::kVectors3, .unit = "m", .help = "Centre of each sphere."},
    {.name = "radii",
     .type = Type::kReals,
     .unit = "m",
     .range = kNotNegative,
     .help = "One for all spheres, or one each. Points on the surface are inside."},
    visual_attribute("isVisible"),
    visual_attribute("drawSphere"),
};
inline constexpr auto kSphereROIAttributes = joined(kSpheres, kRegionAttributes);
inline constexpr Description kSphereROI{.class_name = "SphereROI",
                                        .category = "Engine",
                                        .help = "Finds what lies in spheres.",
                                        .templates = kVec3Templates,
                                        .attributes = kSphereROIAttributes};

inline constexpr Attribute kPlanes[] = {
    {.name = "plane", .type = Type::kReals, .unit = "m", .help = "Ten numbers for each, as orientedBox of BoxROI."},
};
inline constexpr auto kPlaneROIAttributes = joined(kPlanes, kRegionAttributes);
inline constexpr Description kPlaneROI{
    .class_name = "PlaneROI",
    .category = "Engine",
    .help = "Finds what lies in thick rectangles. SOFA's finds no hexahedra; orientedBox of BoxROI does.",
    .templates = kVec3Templates,
    .attributes = kPlaneROIAttributes};

inline constexpr Attribute kEnclosures[] = {
    {.name = "ROIposition", .type = Type::kVectors3, .unit = "m", .help = "Points of a surface."},
    {.name = "ROItriangles",
     .type = Type::kIntegers,
     .range = kIndex,
     .help = "Its triangles. It must be closed and oriented; several points may lie at one place."},
    {.name = "computeMeshROI",
     .type = Type::kBool,
     .initial = "true",
     .help = "false: what lies in the box around the surface."},
    {.name = "box", .type = Type::kBoxes, .unit = "m", .access = Access::kOutput, .help = "Around the surface."},
    ignored_attribute("ROIedges", "Ignored here: the triangles have them."),
    visual_attribute("drawOut"),
    visual_attribute("drawBox"),
};
inline constexpr auto kMeshROIAttributes = [] {
  auto all = joined(kEnclosures, kRegionAttributes);
  for (Attribute& attribute : all)
    if (attribute.name == "strict") attribute.initial = "false";  // unlike the other regions, in SOFA too
  return all;
}();
inline constexpr Description kMeshROI{.class_name = "MeshROI",
                                      .category = "Engine",
                                      .help = "Finds what a closed surface of triangles encloses.",
                                      .templates = kVec3Templates,
                                      .attributes = kMeshROIAttributes};

}  // namespace hexaplast::attributes
