// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <string_view>

/// Names by which older scenes know SOFA's components.
namespace hexaplast::attributes {

/// A class that SOFA has given another name.
struct RenamedClass {
  std::string_view old_name = {};
  std::string_view name = {};
};

/// Old names that SOFA still accepts, and so do we.
inline constexpr std::array kRenamedClasses = {
    RenamedClass{"AffineMovementConstraint", "AffineMovementProjectiveConstraint"},
    RenamedClass{"AttachConstraint", "AttachProjectiveConstraint"},
    RenamedClass{"BilateralInteractionConstraint", "BilateralLagrangianConstraint"},
    RenamedClass{"FixedConstraint", "FixedProjectiveConstraint"},
    RenamedClass{"FixedPlaneConstraint", "FixedPlaneProjectiveConstraint"},
    RenamedClass{"FixedRotationConstraint", "FixedRotationProjectiveConstraint"},
    RenamedClass{"FixedTranslationConstraint", "FixedTranslationProjectiveConstraint"},
    RenamedClass{"LinearMovementConstraint", "LinearMovementProjectiveConstraint"},
    RenamedClass{"LinearVelocityConstraint", "LinearVelocityProjectiveConstraint"},
    RenamedClass{"PartialFixedConstraint", "PartialFixedProjectiveConstraint"},
    RenamedClass{"PartialLinearMovementConstraint", "PartialLinearMovementProjectiveConstraint"},
    RenamedClass{"ParallelStiffSpringForceField", "ParallelSpringForceField"},
    RenamedClass{"ProjectDirectionConstraint", "DirectionProjectiveConstraint"},
    RenamedClass{"ProjectToLineConstraint", "LineProjectiveConstraint"},
    RenamedClass{"ProjectToPlaneConstraint", "PlaneProjectiveConstraint"},
    RenamedClass{"ProjectToPointConstraint", "PointProjectiveConstraint"},
    RenamedClass{"ShewchukPCGLinearSolver", "PCGLinearSolver"},
    RenamedClass{"SlidingConstraint", "SlidingLagrangianConstraint"},
    RenamedClass{"StiffSpringForceField", "SpringForceField"},
    RenamedClass{"StopperConstraint", "StopperLagrangianConstraint"},
    RenamedClass{"UniformConstraint", "UniformLagrangianConstraint"},
    RenamedClass{"UnilateralInteractionConstraint", "UnilateralLagrangianConstraint"},
};

/// Old names that SOFA refuses: what to write instead.
inline constexpr std::array kRetiredClasses = {
    RenamedClass{"CGSolver", "CGLinearSolver"},
    RenamedClass{"ConjugateGradient", "CGLinearSolver"},
    RenamedClass{"CylinderGrid", "CylinderGridTopology"},
    RenamedClass{"DefaultContactManager", "CollisionResponse"},
    RenamedClass{"DefaultPipeline", "CollisionPipeline"},
    RenamedClass{"EulerImplicit", "EulerImplicitSolver"},
    RenamedClass{"Grid", "RegularGridTopology"},
    RenamedClass{"ImplicitEuler", "EulerImplicitSolver"},
    RenamedClass{"ImplicitEulerSolver", "EulerImplicitSolver"},
    RenamedClass{"Mesh", "MeshTopology"},
    RenamedClass{"MeshObjLoader", "MeshOBJLoader"},
    RenamedClass{"OBJExporter", "VisualModelOBJExporter"},
    RenamedClass{"ObjExporter", "VisualModelOBJExporter"},
    RenamedClass{"RegularGrid", "RegularGridTopology"},
    RenamedClass{"RungeKutta4", "RungeKutta4Solver"},
    RenamedClass{"SparseGrid", "SparseGridTopology"},
    RenamedClass{"SparseGridMultiple", "SparseGridMultipleTopology"},
    RenamedClass{"SparseGridRamification", "SparseGridRamificationTopology"},
    RenamedClass{"SphereGrid", "SphereGridTopology"},
};

/// Names that scenes of SOFA still have and that SOFA knows no more: it says so and goes on without them.
inline constexpr std::array kGoneClasses = {
    RenamedClass{"BoxConstraint", "BoxROI and FixedProjectiveConstraint"},
    RenamedClass{"MeshLoader", "MeshOBJLoader"},
};

}  // namespace hexaplast::attributes
