// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace hexaplast::support {

/// A scene of three hexahedra in a row, held at one end and pulled at the other until they flow: six steps, of which
/// every second is written. Tests of commands for which the body does not matter.
inline const std::string kPulledBar =
    "<Node name='root' gravity='0 0 0'>\n<DefaultAnimationLoop/><RunSettings name='settings' steps='6' "
    "outputEvery='2'/>\n"
    "<Node name='bar'><EulerImplicitSolver/><SparseLDLSolver/>\n<RegularGridTopology n='2 2 4'/><MechanicalObject/>"
    "<DiagonalMass/>\n<HexahedronElastoplasticFEMForceField name='material' yieldStress='1' plasticFlowRate='2'/>"
    "<FixedProjectiveConstraint indices='0 1 2 3'/><ConstantForceField indices='12 13 14 15' totalForce='0 0 400'/>"
    "</Node></Node>";

/// A soft bar of 0.1 x 0.1 x 0.3 m that stands on its lower end and yields under little stress.
inline constexpr const char* kBar =
    "<Node dt='0.01' gravity='0 0 0'><DefaultAnimationLoop/>"
    "<EulerImplicitSolver rayleighMass='0.1' rayleighStiffness='0.05'/>"
    "<CGLinearSolver iterations='200' tolerance='1e-9' threshold='1e-30'/>"
    "<RegularGridTopology name='grid' n='3 3 7' max='0.1 0.1 0.3'/><MechanicalObject name='nodes'/>"
    "<UniformMass totalMass='3'/><HexahedronElastoplasticFEMForceField name='body' youngModulus='5000' "
    "poissonRatio='0.4' yieldStress='150' plasticFlowRate='4'/><FixedProjectiveConstraint indices='0-8'/></Node>";

inline std::string bar_with(const std::string& components) {
  const std::string bar = kBar;
  return bar.substr(0, bar.rfind("</Node>")) + components + "</Node>";
}

}  // namespace hexaplast::support
