// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// What pictures show. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kOglModelAttributes[] = {
    {.name = "position",
     .type = Type::kVectors3,
     .unit = "m",
     .help = "Points; default: those of the state that it follows by an IdentityMapping in its node."},
    {.name = "triangles", .type = Type::kIntegers, .range = kIndex, .help = "Groups of three points."},
    {.name = "quads", .type = Type::kIntegers, .range = kIndex, .help = "Groups of four points."},
    visual_attribute("edges"),
    visual_attribute("normals"),
    visual_attribute("texcoords"),
    visual_attribute("color"),
    visual_attribute("material"),
    visual_attribute("texturename"),
    visual_attribute("flipNormals"),
    visual_attribute("useNormals"),
    visual_attribute("updateNormals"),
    visual_attribute("handleDynamicTopology"),
    visual_attribute("fixMergedUVSeams"),
    visual_attribute("isEnabled"),
    visual_attribute("alphaBlend"),
    visual_attribute("depthTest"),
    visual_attribute("cullFace"),
    visual_attribute("lineWidth"),
    visual_attribute("pointSize"),
    visual_attribute("lineSmooth"),
    visual_attribute("pointSmooth"),
    visual_attribute("primitiveType"),
    visual_attribute("blendEquation"),
    visual_attribute("sourceFactor"),
    visual_attribute("destFactor"),
    visual_attribute("blendTransparency"),
};
inline constexpr Description kOglModel{
    .class_name = "OglModel",
    .category = "Visual",
    .help =
        "A surface without mechanics. With a BarycentricMapping or an IdentityMapping in its node, pictures show it in "
        "place of the hexahedra, in their colours; without one they do not show it. What lies in removed hexahedra is "
        "not shown.",
    .templates = "Vec3 Vec3d ExtVec3 ExtVec3d ExtVec3f",
    .attributes = kOglModelAttributes};

inline constexpr Attribute kVisualStyleAttributes[] = {
    {.name = "displayFlags",
     .type = Type::kText,
     .help = "Words that begin with show or hide: VisualModels (surfaces; default show), BehaviorModels (hexahedra; "
             "default: shown where no surface is; beside a surface as edges), ForceFields (arrows of loads; default "
             "show), Wireframe (edges alone, in the colours of what they bound; default hide)."},
};
inline constexpr Description kVisualStyle{.class_name = "VisualStyle",
                                          .category = "Visual",
                                          .help = "What pictures show. The first one in the scene counts.",
                                          .attributes = kVisualStyleAttributes};

inline constexpr Attribute kInteractiveCameraAttributes[] = {
    {.name = "position", .type = Type::kVectors3, .unit = "m", .help = "Where the viewer stands: one point."},
    {.name = "lookAt", .type = Type::kVectors3, .unit = "m", .help = "What the viewer looks at: one point."},
    {.name = "orientation",
     .type = Type::kReals,
     .help = "In place of lookAt: a quaternion x y z w that turns a camera that looks along -z, y pointing up."},
    {.name = "distance",
     .type = Type::kReal,
     .initial = "1",
     .unit = "m",
     .range = kPositive,
     .help = "From the camera to what it looks at, with an orientation."},
    {.name = "fieldOfView",
     .type = Type::kReal,
     .unit = "deg",
     .range = {.min = 0, .max = 180, .exclusive_min = true, .exclusive_max = true},
     .help = "Angle from the lower to the upper border. With it, pictures are taken from the camera's very position; "
             "without, its direction counts, and the distance is fitted to the run."},
    {.name = "projectionType",
     .type = Type::kWord,
     .initial = "Perspective",
     .words = "Perspective Orthographic 0 1",
     .help = "Beside fieldOfView; 0 is Perspective. Fitted pictures are orthographic."},
    visual_attribute("zNear"),
    visual_attribute("zFar"),
    visual_attribute("computeZClip"),
    visual_attribute("minBBox"),
    visual_attribute("maxBBox"),
    visual_attribute("widthViewport"),
    visual_attribute("heightViewport"),
    visual_attribute("activated"),
    visual_attribute("fixedLookAt"),
    visual_attribute("zoomSpeed"),
    visual_attribute("panSpeed"),
    visual_attribute("pivot"),
};
inline constexpr Description kInteractiveCamera{
    .class_name = "InteractiveCamera",
    .category = "Visual",
    .help =
        "From where pictures are taken: from position towards lookAt, y pointing up, or by the orientation. Default: "
        "from beside the body's longest axis and a little above. The first one in the scene counts.",
    .attributes = kInteractiveCameraAttributes};

}  // namespace hexaplast::attributes
