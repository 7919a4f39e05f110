// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/factory.hpp"

/// The core as scene components, and the stock components that a scene needs around them. They translate between scene
/// and core; what they mean is written in the attribute table (attributes/hexaplast.hpp, attributes/stock.hpp).
namespace hexaplast::components {

void add_settings(scene::Factory& factory);        // RunSettings, AttributeChange, and what is ignored
void add_animation_loop(scene::Factory& factory);  // DefaultAnimationLoop
void add_solvers(scene::Factory& factory);         // EulerImplicitSolver, StaticSolver
void add_linear_solvers(scene::Factory& factory);  // CGLinearSolver, SparseLDLSolver, MultigridCGLinearSolver
void add_loaders(scene::Factory& factory);         // MeshGmshLoader, MeshVTKLoader and their like
void add_topologies(scene::Factory& factory);      // RegularGridTopology, MeshTopology and its like
void add_sparse_grids(scene::Factory& factory);    // SparseGridTopology
void add_shapes(scene::Factory& factory);          // TubeGridTopology, SheetGridTopology, SpherePatchGridTopology
void add_states(scene::Factory& factory);          // MechanicalObject
void add_masses(scene::Factory& factory);          // UniformMass, DiagonalMass
void add_engines(scene::Factory& factory);         // BoxROI and its like, IndexValueMapper, IndicesFromValues
void add_constraints(scene::Factory& factory);     // Fixed, PartialFixed, and the movements
void add_attachments(scene::Factory& factory);     // AttachProjectiveConstraint
void add_loads(scene::Factory& factory);           // forces of the scene, pressure, obstacles
void add_springs(scene::Factory& factory);         // SpringForceField, RestShapeSpringsForceField
void add_part_forces(scene::Factory& factory);     // contact, GraspForceField, TangentialForceField
void add_mappings(scene::Factory& factory);        // BarycentricMapping, IdentityMapping
void add_visuals(scene::Factory& factory);         // OglModel, VisualStyle, InteractiveCamera
void add_probes(scene::Factory& factory);          // Probe
void add_bodies(scene::Factory& factory);          // HexahedronElastoplasticFEMForceField
void add_regions(scene::Factory& factory);         // MaterialRegion
void add_blades(scene::Factory& factory);          // BladeController

}  // namespace hexaplast::components
