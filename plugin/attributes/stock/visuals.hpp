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
     .aliases = "vertices",
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
        "A surface that is seen and has no mechanics. With a BarycentricMapping or an IdentityMapping in its node, "
        "pictures show it in place of the hexahedra, in the colours of these; without one they do not show it. "
        "Where hexahedra are removed, what lies in them is not shown. A loader reads and places it.",
    .templates = "Vec3 Vec3d ExtVec3 ExtVec3d ExtVec3f",
    .attributes = kOglModelAttributes};

inline constexpr Attribute kVisualStyleAttributes[] = {
    {.name = "displayFlags",
     .type = Type::kText,
     .help = "Words, of which four pairs count here: showVisualModels (the default) or hideVisualModels for surfaces, "
             "showBehaviorModels or hideBehaviorModels for hexahedra, which are shown by default where no surface is, "
             "and beside a surface as edges; showForceFields (the default) or hideForceFields for the arrows of loads; "
             "showWireframe for edges alone, in the colours of what they bound, or hideWireframe (the default)."},
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
     .help = "In place of lookAt: a quaternion x y z w that turns a camera from looking along -z, y pointing up."},
    {.name = "distance",
     .type = Type::kReal,
     .initial = "1",
     .unit = "m",
     .range = kPositive,
     .help = "From the camera to what it looks at, beside an orientation."},
    {.name = "fieldOfView",
     .type = Type::kReal,
     .unit = "deg",
     .range = {.min = 0, .max = 180, .exclusive_min = true, .exclusive_max = true},
     .help = "Angle from the lower to the upper border. Where it is given, pictures are taken from the camera's very "
             "position; otherwise its direction counts, and distance and detail are fitted to the run."},
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
        "From where pictures are taken: from position towards lookAt, y pointing up, or as the orientation says. "
        "Without them, from beside the body's longest axis and a little above. The first one in the scene counts.",
    .attributes = kInteractiveCameraAttributes};

}  // namespace hexaplast::attributes
