// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "attributes/attribute.hpp"

/// What SOFA scenes hold that has no effect here: whole components, and attributes of others.
namespace hexaplast::attributes {

/// An attribute that is accepted unread.
constexpr Attribute ignored_attribute(std::string_view name, std::string_view help) {
  return {.name = name, .type = Type::kText, .access = Access::kIgnored, .help = help};
}
constexpr Attribute visual_attribute(std::string_view name) { return ignored_attribute(name, "Visual: ignored here."); }

/// A component that is accepted with whatever attributes it has.
constexpr Description ignored_component(std::string_view class_name, std::string_view category, std::string_view help) {
  return {.class_name = class_name, .category = category, .help = help, .takes_anything = true};
}
constexpr Description visual_component(std::string_view class_name) {
  return ignored_component(class_name, "Visual", "visual: ignored here");
}
inline constexpr std::string_view kCollision = "Collision";
constexpr Description collision_component(std::string_view class_name) {
  return ignored_component(
      class_name, kCollision,
      "contact: there is none here; an error, or with --sofa-compat one warning that bodies pass through each other");
}
constexpr Description constraint_component(std::string_view class_name) {
  return ignored_component(class_name, kCollision,
                           "serves constraints by Lagrange multipliers, of contact above all: there are none here; an "
                           "error, or with --sofa-compat without effect");
}
constexpr Description device_component(std::string_view class_name) {
  return ignored_component(class_name, "Interaction", "mouse, devices and their forces: not used here");
}
constexpr Description bookkeeping_component(std::string_view class_name) {
  return ignored_component(class_name, "Bookkeeping", "bookkeeping of SOFA: not needed here");
}

/// Drawing and the user interface: a note. Collision: an error unless the scene is read as SOFA does, for it means
/// something that will not happen. Bookkeeping: nothing is lost, nothing is said.
inline constexpr Description kIgnoredComponents[] = {
    visual_component("VisualModel"),
    visual_component("VisualModelOBJExporter"),
    visual_component("VisualMesh"),
    visual_component("VisualPointCloud"),
    visual_component("VisualGrid"),
    visual_component("VisualTransform"),
    visual_component("VisualBoundingBox"),
    visual_component("VisualVectorField"),
    visual_component("Visual3DText"),
    visual_component("LineAxis"),
    visual_component("TrailRenderer"),
    visual_component("Camera"),
    visual_component("RecordedCamera"),
    visual_component("BackgroundSetting"),
    visual_component("ViewerSetting"),
    visual_component("StatsSetting"),
    visual_component("MouseButtonSetting"),
    visual_component("AttachBodyButtonSetting"),
    visual_component("DefaultVisualManagerLoop"),
    visual_component("LightManager"),
    visual_component("DirectionalLight"),
    visual_component("PositionalLight"),
    visual_component("SpotLight"),
    visual_component("OglColorMap"),
    visual_component("OglGrid"),
    visual_component("OglLabel"),
    visual_component("OglSceneFrame"),
    visual_component("OglViewport"),
    visual_component("DataDisplay"),
    visual_component("ColorMap"),
    visual_component("OglVolumetricModel"),
    visual_component("OglShader"),
    visual_component("OglFloatVariable"),
    visual_component("OglFloat4Attribute"),
    visual_component("OglShadowShader"),
    visual_component("OglTexture"),
    visual_component("OglTexture2D"),
    visual_component("OglOITShader"),
    visual_component("OrderIndependentTransparencyManager"),
    visual_component("PostProcessManager"),
    visual_component("ClipPlane"),
    visual_component("CylinderVisualModel"),
    visual_component("PointSplatModel"),
    visual_component("SlicedVolumetricModel"),
    visual_component("VisualManagerPass"),
    visual_component("CompositingVisualLoop"),
    visual_component("ImageViewer"),
    visual_component("MergeVisualModels"),

    collision_component("CollisionPipeline"),
    collision_component("BruteForceBroadPhase"),
    collision_component("BVHNarrowPhase"),
    collision_component("DirectSAP"),
    collision_component("DirectSAPNarrowPhase"),
    collision_component("IncrSAP"),
    collision_component("MinProximityIntersection"),
    collision_component("NewProximityIntersection"),
    collision_component("LocalMinDistance"),
    collision_component("DiscreteIntersection"),
    collision_component("CollisionResponse"),
    collision_component("RuleBasedContactManager"),
    collision_component("PointCollisionModel"),
    collision_component("LineCollisionModel"),
    collision_component("TriangleCollisionModel"),
    collision_component("SphereCollisionModel"),
    collision_component("CubeCollisionModel"),
    collision_component("RayCollisionModel"),
    collision_component("TetrahedronCollisionModel"),
    collision_component("ContactListener"),
    collision_component("ParallelBruteForceBroadPhase"),
    collision_component("ParallelBVHNarrowPhase"),
    collision_component("FFDDistanceGridCollisionModel"),
    collision_component("RigidDistanceGridCollisionModel"),
    collision_component("CCDTightInclusionIntersection"),
    collision_component("TriangleOctreeCollisionModel"),

    constraint_component("LCPConstraintSolver"),
    constraint_component("BlockGaussSeidelConstraintSolver"),
    constraint_component("UnbuiltGaussSeidelConstraintSolver"),
    constraint_component("NNCGConstraintSolver"),
    constraint_component("ImprovedJacobiConstraintSolver"),
    constraint_component("GenericConstraintSolver"),
    constraint_component("LinearSolverConstraintCorrection"),
    constraint_component("UncoupledConstraintCorrection"),
    constraint_component("GenericConstraintCorrection"),
    constraint_component("PrecomputedConstraintCorrection"),

    device_component("AddFrameButton"),
    device_component("AddRecordedCameraButton"),
    device_component("AttachBodyButton"),
    device_component("ConstraintAttachButtonSetting"),
    device_component("FixPickedParticleButton"),
    device_component("StartNavigationButton"),
    device_component("HaptionDriver"),
    device_component("OmniDriver"),
    device_component("GeomagicDriver"),
    device_component("NewOmniDriver"),
    device_component("LCPForceFeedback"),
    device_component("MechanicalStateForceFeedback"),
    device_component("NullForceFeedback"),
    device_component("MechanicalStateController"),

    bookkeeping_component("HexahedronSetTopologyModifier"),
    bookkeeping_component("HexahedronSetGeometryAlgorithms"),
    bookkeeping_component("QuadSetTopologyModifier"),
    bookkeeping_component("QuadSetGeometryAlgorithms"),
    bookkeeping_component("TetrahedronSetTopologyModifier"),
    bookkeeping_component("TetrahedronSetGeometryAlgorithms"),
    bookkeeping_component("TriangleSetTopologyModifier"),
    bookkeeping_component("TriangleSetGeometryAlgorithms"),
    bookkeeping_component("EdgeSetTopologyModifier"),
    bookkeeping_component("EdgeSetGeometryAlgorithms"),
    bookkeeping_component("PointSetTopologyModifier"),
    bookkeeping_component("PointSetGeometryAlgorithms"),
    bookkeeping_component("TaskSchedulerSettings"),
    bookkeeping_component("CompositeLinearSystem"),
    bookkeeping_component("MatrixProjectionMethod"),
    bookkeeping_component("ConstantSparsityProjectionMethod"),
    bookkeeping_component("GlobalSystemMatrixExporter"),
    bookkeeping_component("GlobalSystemMatrixImage"),
    bookkeeping_component("AMDOrderingMethod"),
    bookkeeping_component("COLAMDOrderingMethod"),
    bookkeeping_component("NaturalOrderingMethod"),
    bookkeeping_component("PreconditionedMatrixFreeSystem"),
    bookkeeping_component("MatrixFreeSystem"),
    bookkeeping_component("RotationMatrixSystem"),
    bookkeeping_component("PrecomputedMatrixSystem"),
};

}  // namespace hexaplast::attributes
