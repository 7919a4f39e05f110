// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"
#include "attributes/stock/ignored.hpp"

/// What pictures show. See stock.hpp.
namespace hexaplast::attributes {

inline constexpr auto kOglModelAttributes = joined(
    std::array{
        vectors3("position", {.unit = "m"},
                 "Points; default: those of the state that it follows by an IdentityMapping in its node."),
        indices("triangles", "Groups of three points."),
        indices("quads", "Groups of four points."),
    },
    visual_attributes("edges", "normals", "texcoords", "color", "material", "texturename", "flipNormals", "useNormals",
                      "updateNormals", "handleDynamicTopology", "fixMergedUVSeams", "isEnabled", "alphaBlend",
                      "depthTest", "cullFace", "lineWidth", "pointSize", "lineSmooth", "pointSmooth", "primitiveType",
                      "blendEquation", "sourceFactor", "destFactor", "blendTransparency"));
inline constexpr Description kOglModel{
    .class_name = "OglModel",
    .category = "Visual",
    .help =
        "A surface without mechanics. With a BarycentricMapping or an IdentityMapping in its node, pictures show it in "
        "place of the hexahedra, in their colours; without one they do not show it. What lies in removed hexahedra is "
        "not shown.",
    .templates = "Vec3 Vec3d ExtVec3 ExtVec3d ExtVec3f",
    .attributes = kOglModelAttributes};

inline constexpr std::array kVisualStyleAttributes = {
    free_text(
        "displayFlags",
        "Words that begin with show or hide: VisualModels (surfaces; default show), BehaviorModels (hexahedra; "
        "default: shown where no surface is; beside a surface as edges), ForceFields (arrows of loads; default show), "
        "Wireframe (edges alone, in the colours of what they bound; default hide)."),
};
inline constexpr Description kVisualStyle{.class_name = "VisualStyle",
                                          .category = "Visual",
                                          .help = "What pictures show. The first one in the scene counts.",
                                          .attributes = kVisualStyleAttributes};

inline constexpr auto kInteractiveCameraAttributes = joined(
    std::array{
        vectors3("position", {.unit = "m"}, "Where the viewer stands: one point."),
        vectors3("lookAt", {.unit = "m"}, "What the viewer looks at: one point."),
        reals("orientation",
              "In place of lookAt: a quaternion x y z w that turns a camera that looks along -z, y pointing up."),
        real("distance", {.initial = "1", .unit = "m", .range = kPositive},
             "From the camera to what it looks at, with an orientation."),
        real("fieldOfView",
             {.unit = "deg", .range = {.min = 0, .max = 180, .exclusive_min = true, .exclusive_max = true}},
             "Angle from the lower to the upper border. With it, pictures are taken from the camera's very position; "
             "without, its direction counts, and the distance is fitted to the run."),
        one_of("projectionType", {.initial = "Perspective", .words = "Perspective Orthographic 0 1"},
               "Beside fieldOfView; 0 is Perspective. Fitted pictures are orthographic."),
    },
    visual_attributes("zNear", "zFar", "computeZClip", "minBBox", "maxBBox", "widthViewport", "heightViewport",
                      "activated", "fixedLookAt", "zoomSpeed", "panSpeed", "pivot"));
inline constexpr Description kInteractiveCamera{
    .class_name = "InteractiveCamera",
    .category = "Visual",
    .help =
        "From where pictures are taken: from position towards lookAt, y pointing up, or by the orientation. Default: "
        "from beside the body's longest axis and a little above. The first one in the scene counts.",
    .attributes = kInteractiveCameraAttributes};

}  // namespace hexaplast::attributes
