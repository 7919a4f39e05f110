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
    RenamedClass{"FixedConstraint", "FixedProjectiveConstraint"},
    RenamedClass{"LinearMovementConstraint", "LinearMovementProjectiveConstraint"},
    RenamedClass{"LinearVelocityConstraint", "LinearVelocityProjectiveConstraint"},
    RenamedClass{"PartialFixedConstraint", "PartialFixedProjectiveConstraint"},
    RenamedClass{"PartialLinearMovementConstraint", "PartialLinearMovementProjectiveConstraint"},
    RenamedClass{"ShewchukPCGLinearSolver", "PCGLinearSolver"},
};

/// Old names that SOFA refuses: what to write instead.
inline constexpr std::array kRetiredClasses = {
    RenamedClass{"CGSolver", "CGLinearSolver"},
    RenamedClass{"ConjugateGradient", "CGLinearSolver"},
    RenamedClass{"DefaultPipeline", "CollisionPipeline"},
    RenamedClass{"EulerImplicit", "EulerImplicitSolver"},
    RenamedClass{"Grid", "RegularGridTopology"},
    RenamedClass{"ImplicitEuler", "EulerImplicitSolver"},
    RenamedClass{"ImplicitEulerSolver", "EulerImplicitSolver"},
    RenamedClass{"Mesh", "MeshTopology"},
    RenamedClass{"MeshObjLoader", "MeshOBJLoader"},
    RenamedClass{"RegularGrid", "RegularGridTopology"},
};

}  // namespace hexaplast::attributes
