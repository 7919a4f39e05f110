// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>
#include <string_view>

/// Names of SOFA that stand for nothing here: of its plugins, and of components that would change the motion.
namespace hexaplast::attributes {

/// Plugins of SOFA's source tree, and what its modules were called as plugins before v22.06. Those of today begin with
/// Sofa. and need no list.
inline constexpr std::string_view kSofaPlugins[] = {
    "ArticulatedSystemPlugin",
    "BeamAdapter",
    "BulletCollisionDetection",
    "CImgPlugin",
    "CollisionOBBCapsule",
    "DiffusionSolver",
    "Geomagic",
    "Haption",
    "HeadlessRecorder",
    "LeapMotion",
    "MultiThreading",
    "PersistentContact",
    "SceneCreator",
    "Sensable",
    "SixenseHydra",
    "SofaBaseCollision",
    "SofaBaseLinearSolver",
    "SofaBaseMechanics",
    "SofaBaseTopology",
    "SofaBaseUtils",
    "SofaBaseVisual",
    "SofaBoundaryCondition",
    "SofaCUDA",
    "SofaCarving",
    "SofaConstraint",
    "SofaDeformable",
    "SofaDenseSolver",
    "SofaDistanceGrid",
    "SofaEngine",
    "SofaEulerianFluid",
    "SofaExplicitOdeSolver",
    "SofaExporter",
    "SofaGeneralAnimationLoop",
    "SofaGeneralDeformable",
    "SofaGeneralEngine",
    "SofaGeneralExplicitOdeSolver",
    "SofaGeneralImplicitOdeSolver",
    "SofaGeneralLinearSolver",
    "SofaGeneralLoader",
    "SofaGeneralMeshCollision",
    "SofaGeneralObjectInteraction",
    "SofaGeneralSimpleFem",
    "SofaGeneralTopology",
    "SofaGeneralVisual",
    "SofaGraphComponent",
    "SofaHAPI",
    "SofaHaptics",
    "SofaImplicitField",
    "SofaImplicitOdeSolver",
    "SofaLoader",
    "SofaMatrix",
    "SofaMatrix.Qt",
    "SofaMatrix.imgui",
    "SofaMeshCollision",
    "SofaMiscCollision",
    "SofaMiscEngine",
    "SofaMiscExtra",
    "SofaMiscFem",
    "SofaMiscForceField",
    "SofaMiscMapping",
    "SofaMiscSolver",
    "SofaMiscTopology",
    "SofaNewmat",
    "SofaNonUniformFem",
    "SofaObjectInteraction",
    "SofaOpenCL",
    "SofaOpenglVisual",
    "SofaPardisoSolver",
    "SofaPreconditioner",
    "SofaRigid",
    "SofaSimpleFem",
    "SofaSparseSolver",
    "SofaSphFluid",
    "SofaTest",
    "SofaTopologicalMapping",
    "SofaUserInteraction",
    "SofaValidation",
    "VolumetricRendering",
    "Xitact",
    "image",
};

constexpr bool is_plugin_of_sofa(std::string_view name) {
  return name.starts_with("Sofa.") || std::ranges::find(kSofaPlugins, name) != std::ranges::end(kSofaPlugins);
}

/// How the names of SOFA's components end that make forces, masses or constraints, or advance or solve something.
inline constexpr std::string_view kEndingsOfPhysics[] = {"ForceField", "ForceFieldAndMass", "Spring", "Springs",
                                                         "Mass",       "Constraint",        "Solver"};

/// Components of SOFA that change the motion and whose names do not end like that.
inline constexpr std::string_view kOtherPhysics[] = {
    "Gravity", "MultiStepAnimationLoop", "MultiTagAnimationLoop", "ReadState", "TopologicalChangeProcessor",
};

/// Whether a component of SOFA that does not exist here would change the motion of a scene.
constexpr bool is_physics_of_sofa(std::string_view class_name) {
  const auto is_end = [&](std::string_view ending) { return class_name.ends_with(ending); };
  return std::ranges::any_of(kEndingsOfPhysics, is_end) ||
         std::ranges::find(kOtherPhysics, class_name) != std::ranges::end(kOtherPhysics);
}

}  // namespace hexaplast::attributes
