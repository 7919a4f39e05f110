// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// What has no effect on a scene: components and attributes that are accepted unread, and what pictures show.
namespace hexaplast::attributes {

/// Attributes of SOFA's components that are accepted unread where a component has none of that name: of drawing and
/// windows, and those for which there is no choice here. Nothing here has them with effect.
inline constexpr std::string_view kPassedOver =
    "alphaBlend angularStiffness animate arrowSizeCoef bbox blendEquation blendTransparency canChangeSleepingState "
    "checkConnexity checkTopology computeAllBuffers computeBoundingBox computeEdgeList computeEdges computeHexahedra "
    "computeHexaList computePointList computeQuadList computeQuads computeResidual "
    "computeTetrahedra computeTriangleList computeTriangles computeZClip createQuadArray createTexCoords "
    "createTriangleArray cullFace depend depthTest derivX destFactor doUpdate drawBox drawBoxes drawEdges "
    "drawForceScale drawHexahedra drawMode drawOut drawPoints drawQuads drawROI drawSize drawSphere drawSpring "
    "drawTetrahedra drawTriangles fixedLookAt fixMergedUVSeams flipNormals forceBinary freeRotations geometryState "
    "graph handleDynamicTopology handleSeams heightViewport isVisible lastFreeRotation "
    "lineSmooth lineWidth listening loadMaterial mapConstraints mapForces mapMasses maxBBox mergePositionUsingMap "
    "minBBox nbPoints orderingMethod output_topology panSpeed parallelInverseProduct parallelODESolving pivot "
    "planeColor pointSize pointSmooth precomputeSymbolicDecomposition preserveTotalMass primitiveType printLog "
    "recompute_indices requireAll requireOne residualGraph restRotations ROIedges savingPrecision "
    "should_diverge_when_residual_is_growing showArrowSize showAxisSizeFactor showBehaviorModels "
    "showBoundingCollisionModels showBoundingTree showCollisionModels showColor showForceFields showGravityCenter "
    "showIndices showIndicesScale showInteractionForceFields showMappings showMechanicalMappings showMovement "
    "showNormals showObject showObjectScale showPlane showPlaneSize showVectors showVectorsScale showVisualModels "
    "showWireFrame showWireframe sleeping solveConstraint sourceFactor springColor stopAfterFirstNameFound "
    "stopAfterFirstSuffixFound storeGroups suffixMap tags texcoords texturename threadSafeVisitor updateNormals "
    "useNormals useTangentStiffness warnWhenDiverge warnWhenLineSearchFails widthViewport zFar zNear zoomSpeed";

/// One that is accepted unread here, and has an effect elsewhere or a name that says too little.
constexpr Attribute ignored(std::string_view name) {
  return free_text(name, {.access = Access::kIgnored}, "Ignored here.");
}

/// A component that is accepted with whatever attributes it has.
constexpr Description ignored_component(std::string_view class_name, std::string_view category, std::string_view help) {
  return {.class_name = class_name, .category = category, .help = help, .takes_anything = true};
}
constexpr Description visual_component(std::string_view class_name) {
  return ignored_component(class_name, "Visual", "visual: ignored here");
}
constexpr Description bookkeeping_component(std::string_view class_name) {
  return ignored_component(class_name, "Bookkeeping", "bookkeeping of SOFA: not needed here");
}

/// Drawing: a note. Bookkeeping: nothing is lost, nothing is said.
inline constexpr Description kIgnoredComponents[] = {
    visual_component("BackgroundSetting"),
    visual_component("DefaultVisualManagerLoop"),
    visual_component("DirectionalLight"),
    visual_component("LightManager"),

    bookkeeping_component("HexahedronSetTopologyModifier"),
    bookkeeping_component("HexahedronSetGeometryAlgorithms"),
    bookkeeping_component("QuadSetTopologyModifier"),
    bookkeeping_component("QuadSetGeometryAlgorithms"),
    bookkeeping_component("TriangleSetGeometryAlgorithms"),
};

// ---- what pictures show

inline constexpr Table kOglModel{
    Category{"Visual", "Vec3 Vec3d ExtVec3 ExtVec3d ExtVec3f"}(
        "OglModel",
        "A surface without mechanics. With a BarycentricMapping or an IdentityMapping in its node, pictures show it in "
        "place of the hexahedra, in their colours; without one they do not show it. What lies in removed hexahedra is "
        "not shown."),
    vectors3("position", {.unit = "m"},
             "Points; default: those of the state that it follows by an IdentityMapping in its node."),
    indices("triangles", "Groups of three points."),
    indices("quads", "Groups of four points."),
    ignored("edges"),
    ignored("normals"),
    ignored("color"),
    ignored("material"),
    ignored("isEnabled"),
};

inline constexpr Table kVisualStyle{
    Category{"Visual"}("VisualStyle", "What pictures show. The first one in the scene counts."),
    free_text(
        "displayFlags",
        "Words that begin with show or hide: VisualModels (surfaces; default show), BehaviorModels (hexahedra; "
        "default: shown where no surface is; beside a surface as edges), ForceFields (arrows of loads; default show). "
        "Others, as showWireframe, have no effect."),
};

inline constexpr Table kInteractiveCamera{
    Category{"Visual"}(
        "InteractiveCamera",
        "From where pictures are taken: from position towards lookAt, y pointing up, or by the orientation. Default: "
        "from beside the body's longest axis and a little above. The first one in the scene counts."),
    vectors3("position", {.unit = "m"}, "Where the viewer stands: one point."),
    vectors3("lookAt", {.unit = "m"}, "What the viewer looks at: one point."),
    reals("orientation",
          "In place of lookAt: a quaternion x y z w that turns a camera that looks along -z, y pointing up."),
    real("distance", {.initial = "1", .unit = "m", .range = kPositive},
         "From the camera to what it looks at, with an orientation."),
    real("fieldOfView", {.unit = "deg", .range = {.min = 0, .max = 180, .exclusive_min = true, .exclusive_max = true}},
         "Angle from the lower to the upper border. With it, pictures are taken from the camera's very position; "
         "without, its direction counts, and the distance is fitted to the run."),
    one_of("projectionType", {.initial = "Perspective", .words = "Perspective Orthographic 0 1"},
           "Beside fieldOfView; 0 is Perspective. Fitted pictures are orthographic."),
    ignored("activated"),
};

}  // namespace hexaplast::attributes
