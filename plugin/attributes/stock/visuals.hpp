// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// What pictures show. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr Attribute kOglModelAttributes[] = {
    {.name = "position", .type = Type::kVectors3, .unit = "m", .aliases = "vertices", .help = "Points."},
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
     .help = "Words, of which two pairs count here: showVisualModels (the default) or hideVisualModels for surfaces, "
             "showBehaviorModels or hideBehaviorModels for hexahedra; these are shown by default where no surface is, "
             "and beside a surface as edges."},
};
inline constexpr Description kVisualStyle{.class_name = "VisualStyle",
                                          .category = "Visual",
                                          .help = "What pictures show. The first one in the scene counts.",
                                          .attributes = kVisualStyleAttributes};

inline constexpr Attribute kInteractiveCameraAttributes[] = {
    {.name = "position", .type = Type::kVectors3, .unit = "m", .help = "Where the viewer stands: one point."},
    {.name = "lookAt", .type = Type::kVectors3, .unit = "m", .help = "What the viewer looks at: one point."},
    visual_attribute("orientation"),
    visual_attribute("distance"),
    visual_attribute("fieldOfView"),
    visual_attribute("zNear"),
    visual_attribute("zFar"),
    visual_attribute("computeZClip"),
    visual_attribute("minBBox"),
    visual_attribute("maxBBox"),
    visual_attribute("widthViewport"),
    visual_attribute("heightViewport"),
    visual_attribute("projectionType"),
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
        "From where pictures are taken: of position and lookAt together the direction counts, y pointing up; "
        "distance and detail are fitted to the run. Without them, from beside the body's longest axis and a little "
        "above. The first one in the scene counts.",
    .attributes = kInteractiveCameraAttributes};

}  // namespace hexaplast::attributes
