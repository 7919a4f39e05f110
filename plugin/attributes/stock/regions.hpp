// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Parts of a body found by their place. See stock.hpp.
namespace hexaplast::attributes {

/// What every region takes and gives.
inline constexpr auto kRegionAttributes = joined(
    std::array{
        vectors3("position", {.unit = "m"}, "Points to select from; default: the rest positions of the nearest state."),
        indices("edges", "Edges to select from; default: those of the nearest topology."),
        indices("triangles", "Triangles to select from; default: those of the nearest topology."),
        indices("quads", "Quads to select from; default: those of the nearest topology."),
        hexahedra("hexahedra", {.range = kIndex}, "Hexahedra to select from; default: those of the nearest topology."),
        boolean("strict", {.initial = "true"},
                "A cell is inside when all its nodes are; otherwise when its centre is."),
        output(integers("indices", "Points inside, ascending.")),
        output(integers("indicesOut", "Points outside, ascending.")),
        output(integer("nbIndices", "How many points are inside.")),
        output(vectors3("pointsInROI", {.unit = "m"}, "Their positions.")),
        output(integers("edgeIndices", "Edges inside, ascending.")),
        output(integers("triangleIndices", "Triangles inside, ascending.")),
        output(integers("quadIndices", "Quads inside, ascending.")),
        output(integers("hexahedronIndices", "Hexahedra inside, ascending.")),
        output(integers("edgesInROI", "Nodes of the edges inside.")),
        output(integers("trianglesInROI", "Nodes of the triangles inside.")),
        output(integers("quadsInROI", "Nodes of the quads inside.")),
        output(hexahedra("hexahedraInROI", "Nodes of the hexahedra inside.")),
        ignored_attribute("doUpdate", "Ignored here: outputs follow their inputs."),
        ignored_attribute("computeEdges", "Ignored here: what is asked for is computed."),
        ignored_attribute("computeTriangles", "Ignored here: what is asked for is computed."),
        ignored_attribute("computeQuads", "Ignored here: what is asked for is computed."),
        ignored_attribute("computeTetrahedra", "Ignored here: there are none."),
        ignored_attribute("computeHexahedra", "Ignored here: what is asked for is computed."),
    },
    visual_attributes("drawROI", "drawPoints"), kDrawnCells, visual_attributes("drawSize"));

inline constexpr std::array kBoxes = {
    boxes("box", {.initial = "0 0 0 1 1 1", .unit = "m"},
          "Two opposite corners of each box, in any order. Points on the border are inside. The default is ignored if "
          "an orientedBox is given."),
    reals("orientedBox", {.unit = "m"},
          "Ten numbers for each box: three consecutive corners of a rectangle, and the thickness, half of it to either "
          "side."),
    visual_attribute("drawBoxes"),
};
inline constexpr auto kBoxROIAttributes = joined(kBoxes, kRegionAttributes);
inline constexpr Description kBoxROI = engine("BoxROI", "Finds what lies in boxes.", kBoxROIAttributes);

inline constexpr std::array kSpheres = {
    vectors3("centers", {.unit = "m"}, "Centre of each sphere."),
    reals("radii", {.unit = "m", .range = kNotNegative},
          "One for all spheres, or one each. Points on the surface are inside."),
    visual_attribute("isVisible"),
    visual_attribute("drawSphere"),
};
inline constexpr auto kSphereROIAttributes = joined(kSpheres, kRegionAttributes);
inline constexpr Description kSphereROI = engine("SphereROI", "Finds what lies in spheres.", kSphereROIAttributes);

inline constexpr std::array kPlanes = {
    reals("plane", {.unit = "m"}, "Ten numbers for each, as orientedBox of BoxROI."),
};
inline constexpr auto kPlaneROIAttributes = joined(kPlanes, kRegionAttributes);
inline constexpr Description kPlaneROI =
    engine("PlaneROI", "Finds what lies in thick rectangles. SOFA's finds no hexahedra; orientedBox of BoxROI does.",
           kPlaneROIAttributes);

inline constexpr std::array kEnclosures = {
    vectors3("ROIposition", {.unit = "m"}, "Points of a surface."),
    indices("ROItriangles", "Its triangles. It must be closed and oriented; several points may lie at one place."),
    boolean("computeMeshROI", {.initial = "true"}, "false: what lies in the box around the surface."),
    output(boxes("box", {.unit = "m"}, "Around the surface.")),
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
inline constexpr Description kMeshROI =
    engine("MeshROI", "Finds what a closed surface of triangles encloses.", kMeshROIAttributes);

}  // namespace hexaplast::attributes
