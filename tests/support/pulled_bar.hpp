// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace hexaplast::support {

// Bars of 1 m along x and a section of 0.25 m^2, held at x = 0. Without lateral contraction the elongation under a
// force F is F / (E A) exactly, whatever the mesh.
inline constexpr double kSection = 0.25;  // [m^2]

inline std::string bar_of_two(const std::string& solver, const std::string& material, const std::string& load) {
  return "<Node dt='0.1' gravity='0 0 0'>\n<DefaultAnimationLoop/><RunSettings steps='11'/>\n" + solver +
         "<RegularGridTopology n='3 2 2' max='1 .5 .5'/><MechanicalObject/>\n"
         "<HexahedronElastoplasticFEMForceField name='body' youngModulus='2000' poissonRatio='0' " +
         material + "/>\n<FixedProjectiveConstraint indices='0 3 6 9'/>" + load + "</Node>";
}

/// In equilibrium at each of its 11 steps. The pull grows to 50 N at t = 1 s, which step 11 begins with.
inline std::string pulled_bar() {
  return bar_of_two(
      "<StaticSolver newtonSolver='@newton' linearSolver='@factors'/><NewtonRaphsonSolver name='newton' "
      "maxNbIterationsNewton='50' relativeSuccessiveStoppingThreshold='0' relativeInitialStoppingThreshold='0' "
      "absoluteResidualStoppingThreshold='1e-10'/><SparseLDLSolver name='factors'/>\n",
      "", "<LinearForceField name='pull' points='2 5 8 11' times='0 1' forces='0 0 0  12.5 0 0'/>");
}

}  // namespace hexaplast::support
