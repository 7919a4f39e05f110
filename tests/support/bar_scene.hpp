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

}  // namespace hexaplast::support
