// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "scene/factory.hpp"

namespace hexaplast::components {

/// The core as scene components, and the stock components that a scene needs around them. They translate between scene
/// and core; what they mean is written in the attribute table (attributes/hexaplast.hpp, attributes/stock.hpp).
void add_settings(scene::Factory& factory);     // RunSettings, AttributeChange, and what is ignored
void add_solvers(scene::Factory& factory);      // the animation loop, time integrators, linear solvers
void add_loaders(scene::Factory& factory);      // MeshGmshLoader, MeshVTKLoader and their like
void add_topologies(scene::Factory& factory);   // grids, MeshTopology and its like
void add_states(scene::Factory& factory);       // MechanicalObject
void add_masses(scene::Factory& factory);       // UniformMass, DiagonalMass
void add_engines(scene::Factory& factory);      // BoxROI and its like, IndexValueMapper, IndicesFromValues
void add_constraints(scene::Factory& factory);  // Fixed, PartialFixed, and the movements
void add_attachments(scene::Factory& factory);  // AttachProjectiveConstraint
void add_loads(scene::Factory& factory);        // forces of the scene, pressure, obstacles
void add_springs(scene::Factory& factory);      // SpringForceField, RestShapeSpringsForceField
void add_part_forces(scene::Factory& factory);  // contact, GraspForceField, TangentialForceField, BladeController
void add_bodies(scene::Factory& factory);       // HexahedronElastoplasticFEMForceField, MaterialRegion
void add_mappings(scene::Factory& factory);     // BarycentricMapping, IdentityMapping
void add_visuals(scene::Factory& factory);      // OglModel, VisualStyle, InteractiveCamera
void add_probes(scene::Factory& factory);       // Probe

}  // namespace hexaplast::components
