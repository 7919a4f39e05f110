// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// Points that are read, or moved before the run. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kTransformEngineAttributes[] = {
    {.name = "input_position", .type = Type::kVectors3, .unit = "m", .help = "Points."},
    {.name = "scale", .type = Type::kVector3, .initial = "1 1 1", .help = "Applied first."},
    {.name = "rotation",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "deg",
     .help = "About x, then y, then z; applied second."},
    {.name = "quaternion", .type = Type::kReals, .help = "x y z w, instead of rotation."},
    {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
    {.name = "inverse",
     .type = Type::kBool,
     .initial = "false",
     .help = "The way back: minus the translation first, the scale last."},
    {.name = "output_position",
     .type = Type::kVectors3,
     .unit = "m",
     .access = Access::kOutput,
     .help = "The moved points."},
};
inline constexpr Description kTransformEngine{.class_name = "TransformEngine",
                                              .category = "Engine",
                                              .help = "Scales, turns and moves points.",
                                              .templates = kVec3Templates,
                                              .attributes = kTransformEngineAttributes};

inline constexpr Attribute kTransformPositionAttributes[] = {
    {.name = "input_position", .type = Type::kVectors3, .unit = "m", .aliases = "inputPosition", .help = "Points."},
    {.name = "method",
     .type = Type::kWord,
     .initial = "projectOnPlane",
     .words = "projectOnPlane translation rotation scale scaleTranslation scaleRotationTranslation affine fromFile",
     .help = "Which of the attributes below count. fromFile takes the matrix from a file."},
    {.name = "origin", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "A point of the plane."},
    {.name = "normal", .type = Type::kVector3, .initial = "0 0 0", .help = "Of the plane, of any length."},
    {.name = "scale", .type = Type::kVector3, .initial = "1 1 1", .help = "Applied first."},
    {.name = "rotation",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "deg",
     .help = "About x, then y, then z; applied second."},
    {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
    {.name = "matrix", .type = Type::kReals, .help = "For affine: homogeneous 4 x 4 matrix, row by row."},
    {.name = "filename",
     .type = Type::kText,
     .help = "For fromFile: a .tfm file. Its line Parameters has nine numbers of a matrix, row by row, and three of a "
             "translation, which SOFA takes as z, y, x."},
    {.name = "fixedIndices", .type = Type::kIntegers, .range = kIndex, .help = "Points that stay where they are."},
    {.name = "output_position",
     .type = Type::kVectors3,
     .unit = "m",
     .aliases = "outputPosition",
     .access = Access::kOutput,
     .help = "The moved points."},
    visual_attribute("drawInput"),
    visual_attribute("drawOutput"),
    visual_attribute("pointSize"),
};
inline constexpr Description kTransformPosition{.class_name = "TransformPosition",
                                                .category = "Engine",
                                                .help = "Moves points by one of several methods.",
                                                .templates = kVec3Templates,
                                                .attributes = kTransformPositionAttributes};

inline constexpr Attribute kSphereLoaderAttributes[] = {
    {.name = "filename",
     .type = Type::kText,
     .help =
         "A .sph file: lines `sphe NUMBER X Y Z RADIUS`. A relative path counts from the scene file that names it."},
    {.name = "scale", .type = Type::kVector3, .initial = "1 1 1", .aliases = "scale3d", .help = "Applied first."},
    {.name = "rotation",
     .type = Type::kVector3,
     .initial = "0 0 0",
     .unit = "deg",
     .help = "About x, then y, then z; applied second."},
    {.name = "translation", .type = Type::kVector3, .initial = "0 0 0", .unit = "m", .help = "Applied last."},
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .aliases = "sphere_centers",
     .access = Access::kOutput,
     .help = "Centres."},
    {.name = "listRadius",
     .type = Type::kReals,
     .unit = "m",
     .access = Access::kOutput,
     .help = "Radii, as they are in the file."},
};
inline constexpr Description kSphereLoader{.class_name = "SphereLoader",
                                           .category = "MeshLoader",
                                           .help = "Reads the spheres of a .sph file.",
                                           .attributes = kSphereLoaderAttributes};

}  // namespace hexaplast::attributes
