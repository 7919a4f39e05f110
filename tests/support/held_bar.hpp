// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace hexaplast::support {

/// A bar of two hexahedra that is held at one end and pulled, with the components "material" and "pull": attributes of
/// the solver of motion, of the material and of a ConstantForceField.
inline std::string held_bar(const std::string& solver, const std::string& material, const std::string& pull) {
  return "<EulerImplicitSolver " + solver +
         "/><SparseLDLSolver/><RegularGridTopology name='grid' n='3 2 2'/><MechanicalObject/><DiagonalMass/>"
         "<HexahedronElastoplasticFEMForceField name='material' " +
         material + "/><FixedProjectiveConstraint indices='0 3 6 9'/><ConstantForceField name='pull' " + pull + "/>";
}

/// A scene of components in a node "bar", with attributes of RunSettings.
inline std::string in_a_node(const std::string& components, const std::string& settings) {
  return "<Node name='root' gravity='0 0 0' dt='0.01'><DefaultAnimationLoop/><RunSettings " + settings +
         "/><Node name='bar'>" + components + "</Node></Node>";
}

}  // namespace hexaplast::support
