// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string_view>

#include "attributes/words.hpp"

/// Names that scenes could have in earlier versions, and what to write instead: what the errors of such a scene say.
namespace hexaplast::attributes {

struct Gone {
  std::string_view names = {};  ///< of components, CLASS.attribute, or .attribute of any class; separated by blanks
  std::string_view instead = {};
};

inline constexpr Gone kGone[] = {
    // other names of components that are there
    {"AttachConstraint", "take AttachProjectiveConstraint"},
    {"FixedConstraint", "take FixedProjectiveConstraint"},
    {"LinearMovementConstraint", "take LinearMovementProjectiveConstraint"},
    {"PartialFixedConstraint", "take PartialFixedProjectiveConstraint"},
    {"PartialLinearMovementConstraint", "take PartialLinearMovementProjectiveConstraint"},
    {"StiffSpringForceField", "take SpringForceField"},
    {"CGSolver ConjugateGradient ParallelCGLinearSolver", "take CGLinearSolver"},
    {"EulerImplicit ImplicitEuler ImplicitEulerSolver", "take EulerImplicitSolver"},
    {"Grid RegularGrid", "take RegularGridTopology"},
    {"Mesh TetrahedronSetTopologyContainer EdgeSetTopologyContainer PointSetTopologyContainer", "take MeshTopology"},
    {"MeshObjLoader MeshLoader", "take MeshOBJLoader"},
    {"SparseGrid", "take SparseGridTopology"},
    {"BoxConstraint", "take BoxROI and FixedProjectiveConstraint"},
    {"FreeMotionAnimationLoop", "take DefaultAnimationLoop"},

    // motion
    {"EulerExplicitSolver RungeKutta2Solver RungeKutta4Solver RungeKutta4 CentralDifferenceSolver "
     "NewmarkImplicitSolver",
     "take EulerImplicitSolver; the scene with this integrator runs in SOFA, with the plugin Hexaplast"},
    {"EigenSimplicialLDLT EigenSimplicialLLT EigenSparseLU EigenSparseQR CholeskySolver LULinearSolver BTDLinearSolver "
     "SparsePARDISOSolver SparseCholeskySolver SparseLUSolver SVDLinearSolver AsyncSparseLDLSolver "
     "PrecomputedLinearSolver",
     "take SparseLDLSolver"},
    {"PCGLinearSolver ShewchukPCGLinearSolver MinResLinearSolver JacobiPreconditioner BlockJacobiPreconditioner "
     "SSORPreconditioner WarpPreconditioner PrecomputedWarpPreconditioner",
     "take MultigridCGLinearSolver, which has its own preconditioners, or CGLinearSolver"},
    {"MatrixLinearSystem ConstantSparsityPatternSystem CompositeLinearSystem MatrixFreeSystem "
     "PreconditionedMatrixFreeSystem RotationMatrixSystem PrecomputedMatrixSystem MatrixProjectionMethod "
     "ConstantSparsityProjectionMethod GlobalSystemMatrixExporter GlobalSystemMatrixImage AMDOrderingMethod "
     "COLAMDOrderingMethod NaturalOrderingMethod CGLinearSolver.linearSystem SparseLDLSolver.linearSystem",
     "leave it out: linear solvers assemble their own matrices"},
    {"StaticSolver.newton_iterations", "take NewtonRaphsonSolver.maxNbIterationsNewton"},
    {"StaticSolver.absolute_residual_tolerance_threshold",
     "take NewtonRaphsonSolver.absoluteResidualStoppingThreshold"},
    {"StaticSolver.relative_residual_tolerance_threshold", "take NewtonRaphsonSolver.relativeInitialStoppingThreshold"},
    {"StaticSolver.absolute_correction_tolerance_threshold",
     "take NewtonRaphsonSolver.absoluteEstimateDifferenceThreshold"},
    {"StaticSolver.relative_correction_tolerance_threshold",
     "take NewtonRaphsonSolver.relativeEstimateDifferenceThreshold"},

    // bodies, masses and forces
    {"HexahedronFEMForceField ParallelHexahedronFEMForceField HexahedralFEMForceField",
     "take HexahedronElastoplasticFEMForceField"},
    {"HexahedronFEMForceFieldAndMass HexahedralFEMForceFieldAndMass",
     "take HexahedronElastoplasticFEMForceField and DiagonalMass"},
    {"TetrahedronFEMForceField TriangularFEMForceField TriangleFEMForceField",
     "hexahedra alone deform; the scene runs in SOFA, with the plugin Hexaplast"},
    {"MeshMatrixMass", "take DiagonalMass"},
    {"MeshSpringForceField RegularGridSpringForceField TriangularBendingSprings QuadularBendingSprings",
     "take SpringForceField, which lists its pairs of nodes"},
    {"QuadPressureForceField", "take SurfacePressureForceField, or ConstantForceField for a fixed direction"},
    {"UniformVelocityDampingForceField", "take EulerImplicitSolver.rayleighMass"},
    {"AffineMovementConstraint AffineMovementProjectiveConstraint", "take LinearMovementProjectiveConstraint"},
    {"SubsetMapping", "take BarycentricMapping"},
    {"RigidMapping", "rigid frames are SOFA's; the scene runs in SOFA, with the plugin Hexaplast"},
    {"InstrumentContactForceField.rigid InstrumentContactForceField.rigidIndex",
     "take keyTimes, positions and orientations; a frame moves the instrument in SOFA, with the plugin Hexaplast"},

    // meshes
    {"CylinderGrid CylinderGridTopology SphereGrid SphereGridTopology",
     "take TubeGridTopology, or SparseGridTopology around a surface"},
    {"SparseGridRamification SparseGridRamificationTopology SparseGridMultiple SparseGridMultipleTopology",
     "take SparseGridTopology, and a MaterialRegion for what is stiffer"},
    {"SparseGridTopology.nbVirtualFinerLevels", "leave it out: the cells of n are kept that the surface touches"},
    {"Hexa2QuadTopologicalMapping Quad2TriangleTopologicalMapping Hexa2TetraTopologicalMapping "
     "Tetra2TriangleTopologicalMapping",
     "leave it out: pictures show the faces of hexahedra, and a mesh loader reads other surfaces"},
    {"ExtrudeQuadsAndGenerateHexas", "`hexaplast mesh offset` makes the mesh, and MeshVTKLoader reads it"},
    {"TransformEngine TransformPosition", "take scale3d, rotation and translation of a loader or a MechanicalObject"},
    {"SphereLoader", "take MechanicalObject.position"},
    {"RegularGridTopology.nx RegularGridTopology.ny RegularGridTopology.nz", "take n"},
    {"RegularGridTopology.xmin RegularGridTopology.ymin RegularGridTopology.zmin RegularGridTopology.xmax "
     "RegularGridTopology.ymax RegularGridTopology.zmax RegularGridTopology.p0",
     "take min and max"},
    {"RegularGridTopology.triangles", "take quads"},
    {"MeshTopology.tetrahedra MeshTopology.tetras MeshTopology.prisms MeshTopology.pyramids",
     "leave it out: hexahedra alone deform"},
    {"MechanicalObject.sx MechanicalObject.sy MechanicalObject.sz", "take scale3d"},
    {"MechanicalObject.rx MechanicalObject.ry MechanicalObject.rz", "take rotation"},
    {"MechanicalObject.dx MechanicalObject.dy MechanicalObject.dz", "take translation"},

    // other names of attributes that are there
    {"HexahedronElastoplasticFEMForceField.gradient", "take bending"},
    {"HexahedronElastoplasticFEMForceField.blendShare", "take blendWeight"},
    {"HexahedronElastoplasticFEMForceField.mooneyShare", "take mooneyFraction"},
    {"HexahedronElastoplasticFEMForceField.materialPositions", "take plasticRestPositions"},
    {"HexahedronElastoplasticFEMForceField.drawMaterialShape", "take drawPlasticRestShape"},
    {"InstrumentContactForceField.skinPositions", "take embeddedPositions"},
    {"InstrumentContactForceField.skinTriangles", "take embeddedTriangles"},
    {"BoxROI.rest_position SphereROI.rest_position PlaneROI.rest_position MeshROI.rest_position OglModel.vertices "
     "MeshTopology.points RegularGridTopology.points SparseGridTopology.points TubeGridTopology.points "
     "SheetGridTopology.points SpherePatchGridTopology.points HexahedronSetTopologyContainer.points "
     "QuadSetTopologyContainer.points TriangleSetTopologyContainer.points",
     "take position"},
    {"BoxROI.pointIndices SphereROI.pointIndices PlaneROI.pointIndices MeshROI.pointIndices", "take indices"},
    {".hexas", "take hexahedra"},
    {".lines", "take edges"},
    {"SparseGridTopology.filename", "take fileTopology"},
    {"SpringForceField.length", "take lengths"},
    {"RestShapeSpringsForceField.indices", "take points"},
    {"FixedProjectiveConstraint.projectVelocity", "take activate_projectVelocity"},
    {"PartialFixedProjectiveConstraint.activate_projectVelocity", "take projectVelocity"},

    // attributes of SOFA that no scene of ours has
    {"AttachProjectiveConstraint.constraintFactor AttachProjectiveConstraint.positionFactor "
     "AttachProjectiveConstraint.velocityFactor AttachProjectiveConstraint.minDistance "
     "AttachProjectiveConstraint.endTime SurfacePressureForceField.mainDirection SurfacePressureForceField.pulseMode "
     "SurfacePressureForceField.volumeConservationMode SurfacePressureForceField.pressureLowerBound "
     "SurfacePressureForceField.pressureSpeed SurfacePressureForceField.defaultVolume",
     "leave it out; the scene with it runs in SOFA, with the plugin Hexaplast"},
    {"MechanicalObject.translation2 MechanicalObject.rotation2", "take rest_position, and position or translation"},
    {"MeshVTKLoader.transformation MeshGmshLoader.transformation MeshOBJLoader.transformation "
     "MeshSTLLoader.transformation",
     "take scale3d, rotation and translation"},
    {"Node.activated", "make the node a comment"},
    {"ConstantForceField.indexFromEnd", "take indices from the beginning"},
    {"LinearMovementProjectiveConstraint.relativeMovements", "take movements from where the nodes begin"},

    {"VTKExporter", "leave it out: a run writes mesh.pvd and its .vtu files"},
    {"WriteState", "leave it out: a run writes states with --data, and its last one with --final"},

    // what had no effect
    {"VisualModel VisualModelOBJExporter OBJExporter ObjExporter VisualMesh VisualPointCloud VisualGrid "
     "VisualTransform VisualBoundingBox VisualVectorField Visual3DText LineAxis TrailRenderer Camera RecordedCamera "
     "ViewerSetting StatsSetting MouseButtonSetting AttachBodyButtonSetting PositionalLight SpotLight OglColorMap "
     "OglGrid OglLabel OglSceneFrame OglViewport DataDisplay ColorMap OglVolumetricModel OglShader OglFloatVariable "
     "OglFloat4Attribute OglShadowShader OglTexture OglTexture2D OglOITShader OrderIndependentTransparencyManager "
     "PostProcessManager ClipPlane CylinderVisualModel PointSplatModel SlicedVolumetricModel VisualManagerPass "
     "CompositingVisualLoop ImageViewer MergeVisualModels",
     "leave it out: it is for the windows of SOFA"},
    {"AddFrameButton AddRecordedCameraButton AttachBodyButton ConstraintAttachButtonSetting FixPickedParticleButton "
     "StartNavigationButton HaptionDriver OmniDriver GeomagicDriver NewOmniDriver LCPForceFeedback "
     "MechanicalStateForceFeedback NullForceFeedback MechanicalStateController",
     "leave it out: mouse and devices act in SOFA alone"},
    {"TetrahedronSetTopologyModifier TetrahedronSetGeometryAlgorithms TriangleSetTopologyModifier "
     "EdgeSetTopologyModifier EdgeSetGeometryAlgorithms PointSetTopologyModifier PointSetGeometryAlgorithms "
     "TaskSchedulerSettings",
     "leave it out: it has no effect here"},
    {"CollisionPipeline DefaultPipeline BruteForceBroadPhase BVHNarrowPhase ParallelBruteForceBroadPhase "
     "ParallelBVHNarrowPhase DirectSAP DirectSAPNarrowPhase IncrSAP MinProximityIntersection NewProximityIntersection "
     "LocalMinDistance DiscreteIntersection CCDTightInclusionIntersection CollisionResponse DefaultContactManager "
     "RuleBasedContactManager PointCollisionModel LineCollisionModel TriangleCollisionModel SphereCollisionModel "
     "CubeCollisionModel RayCollisionModel TetrahedronCollisionModel TriangleOctreeCollisionModel "
     "FFDDistanceGridCollisionModel RigidDistanceGridCollisionModel ContactListener LCPConstraintSolver "
     "BlockGaussSeidelConstraintSolver UnbuiltGaussSeidelConstraintSolver NNCGConstraintSolver "
     "ImprovedJacobiConstraintSolver GenericConstraintSolver LinearSolverConstraintCorrection "
     "UncoupledConstraintCorrection GenericConstraintCorrection PrecomputedConstraintCorrection",
     "take TissueContactForceField between bodies and InstrumentContactForceField for instruments; SOFA's contact acts "
     "in SOFA alone"},
};

/// What to write instead of a component, CLASS.attribute or .attribute; empty: there never was one of that name.
inline std::string_view instead_of(std::string_view name) {
  std::string_view instead;
  for (const Gone& gone : kGone)
    for_each_word(gone.names, [&](std::string_view word) {
      if (word == name) instead = gone.instead;
    });
  return instead;
}

}  // namespace hexaplast::attributes
