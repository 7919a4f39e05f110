// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Our own topologies: grids bent into the shapes of organs. SOFA has none of them.
namespace hexaplast::attributes {

inline constexpr Range kShapeCells{.min = 1, .max = 1000000};

inline constexpr std::array kShapeOutputs = {
    output(vectors3("position", {.unit = "m"}, "Nodes, the first direction fastest.")),
    output(hexahedra("hexahedra", "Cells, the first direction fastest.")),
    output(integers("quads", "Faces of the cells, each once: groups of four nodes.")),
    output(integers("edges", "Edges of the cells, each once: pairs of nodes.")),
};
inline constexpr Attribute kInnerRadius =
    real("innerRadius", {.initial = "0.01", .unit = "m", .range = kPositive}, "Inside.");
inline constexpr Attribute kOuterRadius = real("outerRadius", {.initial = "0.012", .unit = "m", .range = kPositive},
                                               "Outside; must be greater than innerRadius.");

inline constexpr Table kTubeGridTopology{
    topology("TubeGridTopology",
             "A tube, straight, along an arc or along a curve. The first node of each circle lies on the side of x (of "
             "y where the curve begins along x); sections do not turn about the curve."),
    integers("cells", {.initial = "2 16 20", .range = kShapeCells},
             "Hexahedra outward, around (at least 3) and along."),
    kInnerRadius,
    kOuterRadius,
    real("length", {.initial = "0.1", .unit = "m", .range = kPositive},
         "From the origin along z. Ignored if a centreline is given."),
    real("bend",
         {.initial = "0",
          .unit = "deg",
          .range = {.min = -360, .max = 360, .exclusive_min = true, .exclusive_max = true}},
         "Angle by which the tube is bent towards x, along an arc. Ignored if a centreline is given."),
    vectors3("centreline", {.unit = "m"},
             "At least two points of a smooth curve that the tube follows instead. The hexahedra along it are equally "
             "long."),
    kShapeOutputs,
};

inline constexpr Table kSheetGridTopology{
    topology("SheetGridTopology", "A sheet about the origin, flat or bent like a cylinder."),
    integers("cells", {.initial = "16 16 2", .range = kShapeCells}, "Hexahedra along x, along y and across."),
    reals("size", {.initial = "0.1 0.1", .unit = "m", .range = kPositive},
          "Lengths along x and y, measured in the middle of the thickness."),
    real("thickness", {.initial = "0.002", .unit = "m", .range = kPositive},
         "Along z, half of it to either side of the origin."),
    real("curvature", {.initial = "0", .unit = "1/m"},
         "One over the radius of bending about an axis along y. Positive: the ends sink; negative: they rise."),
    kShapeOutputs,
};

inline constexpr Table kSpherePatchGridTopology{
    topology("SpherePatchGridTopology",
             "A square patch of a spherical shell about the origin, around the z axis, cut along great circles."),
    integers("cells", {.initial = "16 16 2", .range = kShapeCells}, "Hexahedra along x, along y and outward."),
    kInnerRadius,
    kOuterRadius,
    real(
        "angle",
        {.initial = "90", .unit = "deg", .range = {.min = 0, .max = 180, .exclusive_min = true, .exclusive_max = true}},
        "From side to side, seen from the centre."),
    kShapeOutputs,
};

}  // namespace hexaplast::attributes
