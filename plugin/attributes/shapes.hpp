// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// Our own topologies: grids bent into the shapes of organs. SOFA has none of them.
namespace hexaplast::attributes {

inline constexpr Range kShapeCells{.min = 1, .max = 1000000};

inline constexpr Attribute kShapePosition{.name = "position",
                                          .type = Type::kVectors3,
                                          .unit = "m",
                                          .access = Access::kOutput,
                                          .help = "Nodes, the first direction fastest."};
inline constexpr Attribute kShapeHexahedra{.name = "hexahedra",
                                           .type = Type::kHexahedra,
                                           .access = Access::kOutput,
                                           .help = "Cells, the first direction fastest."};
inline constexpr Attribute kShapeQuads{.name = "quads",
                                       .type = Type::kIntegers,
                                       .access = Access::kOutput,
                                       .help = "Faces of the cells, each once: groups of four nodes."};
inline constexpr Attribute kShapeEdges{.name = "edges",
                                       .type = Type::kIntegers,
                                       .access = Access::kOutput,
                                       .help = "Edges of the cells, each once: pairs of nodes."};
inline constexpr Attribute kInnerRadius{
    .name = "innerRadius", .type = Type::kReal, .initial = "0.01", .unit = "m", .range = kPositive, .help = "Inside."};
inline constexpr Attribute kOuterRadius{.name = "outerRadius",
                                        .type = Type::kReal,
                                        .initial = "0.012",
                                        .unit = "m",
                                        .range = kPositive,
                                        .help = "Outside; must be greater than innerRadius."};

inline constexpr Attribute kTubeGridTopologyAttributes[] = {
    {.name = "cells",
     .type = Type::kIntegers,
     .initial = "2 16 20",
     .range = kShapeCells,
     .help = "Hexahedra outward, around (at least 3) and along."},
    kInnerRadius,
    kOuterRadius,
    {.name = "length",
     .type = Type::kReal,
     .initial = "0.1",
     .unit = "m",
     .range = kPositive,
     .help = "From the origin along z. Ignored if a centreline is given."},
    {.name = "bend",
     .type = Type::kReal,
     .initial = "0",
     .unit = "deg",
     .range = {.min = -360, .max = 360, .exclusive_min = true, .exclusive_max = true},
     .help = "Angle by which the tube is bent towards x, along an arc. Ignored if a centreline is given."},
    {.name = "centreline",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "At least two points of a smooth curve that the tube follows instead. The hexahedra along it are equally "
             "long."},
    kShapePosition,
    kShapeHexahedra,
    kShapeQuads,
    kShapeEdges,
};
inline constexpr Description kTubeGridTopology{
    .class_name = "TubeGridTopology",
    .category = "Topology",
    .help =
        "A tube, straight, along an arc or along a curve. The first node of each circle lies on the side of x (of y "
        "where the curve begins along x); sections do not turn about the curve.",
    .attributes = kTubeGridTopologyAttributes};

inline constexpr Attribute kSheetGridTopologyAttributes[] = {
    {.name = "cells",
     .type = Type::kIntegers,
     .initial = "16 16 2",
     .range = kShapeCells,
     .help = "Hexahedra along x, along y and across."},
    {.name = "size",
     .type = Type::kReals,
     .initial = "0.1 0.1",
     .unit = "m",
     .range = kPositive,
     .help = "Lengths along x and y, measured in the middle of the thickness."},
    {.name = "thickness",
     .type = Type::kReal,
     .initial = "0.002",
     .unit = "m",
     .range = kPositive,
     .help = "Along z, half of it to either side of the origin."},
    {.name = "curvature",
     .type = Type::kReal,
     .initial = "0",
     .unit = "1/m",
     .help = "One over the radius of bending about an axis along y. Positive: the ends sink; negative: they rise."},
    kShapePosition,
    kShapeHexahedra,
    kShapeQuads,
    kShapeEdges,
};
inline constexpr Description kSheetGridTopology{.class_name = "SheetGridTopology",
                                                .category = "Topology",
                                                .help = "A sheet about the origin, flat or bent like a cylinder.",
                                                .attributes = kSheetGridTopologyAttributes};

inline constexpr Attribute kSpherePatchGridTopologyAttributes[] = {
    {.name = "cells",
     .type = Type::kIntegers,
     .initial = "16 16 2",
     .range = kShapeCells,
     .help = "Hexahedra along x, along y and outward."},
    kInnerRadius,
    kOuterRadius,
    {.name = "angle",
     .type = Type::kReal,
     .initial = "90",
     .unit = "deg",
     .range = {.min = 0, .max = 180, .exclusive_min = true, .exclusive_max = true},
     .help = "From side to side, seen from the centre."},
    kShapePosition,
    kShapeHexahedra,
    kShapeQuads,
    kShapeEdges,
};
inline constexpr Description kSpherePatchGridTopology{
    .class_name = "SpherePatchGridTopology",
    .category = "Topology",
    .help = "A square patch of a spherical shell about the origin, around the z axis, cut along great circles.",
    .attributes = kSpherePatchGridTopologyAttributes};

}  // namespace hexaplast::attributes
