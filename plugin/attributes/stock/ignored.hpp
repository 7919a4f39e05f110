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
constexpr Description bookkeeping_component(std::string_view class_name) {
  return ignored_component(class_name, "Bookkeeping", "bookkeeping of SOFA: not needed here");
}

/// Drawing and the user interface: a note. Collision: an error unless the scene is read as SOFA does, for it means
/// something that will not happen. Bookkeeping: nothing is lost, nothing is said.
inline constexpr Description kIgnoredComponents[] = {
    visual_component("VisualModel"),
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
    collision_component("LCPConstraintSolver"),
    collision_component("GenericConstraintSolver"),
    collision_component("BlockGaussSeidelConstraintSolver"),
    collision_component("UnbuiltGaussSeidelConstraintSolver"),
    collision_component("NNCGConstraintSolver"),
    collision_component("ImprovedJacobiConstraintSolver"),
    collision_component("UncoupledConstraintCorrection"),
    collision_component("LinearSolverConstraintCorrection"),
    collision_component("GenericConstraintCorrection"),
    collision_component("PrecomputedConstraintCorrection"),

    bookkeeping_component("HexahedronSetTopologyModifier"),
    bookkeeping_component("HexahedronSetGeometryAlgorithms"),
    bookkeeping_component("QuadSetTopologyModifier"),
    bookkeeping_component("QuadSetGeometryAlgorithms"),
    bookkeeping_component("AMDOrderingMethod"),
    bookkeeping_component("COLAMDOrderingMethod"),
    bookkeeping_component("NaturalOrderingMethod"),
    bookkeeping_component("PreconditionedMatrixFreeSystem"),
    bookkeeping_component("MatrixFreeSystem"),
    bookkeeping_component("RotationMatrixSystem"),
    bookkeeping_component("PrecomputedMatrixSystem"),
    bookkeeping_component("CompositeLinearSystem"),
    bookkeeping_component("MatrixProjectionMethod"),
    bookkeeping_component("ConstantSparsityProjectionMethod"),
    bookkeeping_component("TaskSchedulerSettings"),
};

}  // namespace hexaplast::attributes
