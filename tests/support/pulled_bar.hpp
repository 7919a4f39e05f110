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

/// The same pull on a bar that contracts freely across, or not at all, with the element whose law is that of Hooke for
/// such stretches: the elongation is F / (E A) or F / (M A), M = E (1 - nu) / ((1 + nu) (1 - 2 nu)).
inline std::string pulled_bar(bool is_confined) {
  std::string scene = pulled_bar();
  const auto replace = [&](const std::string& what, const std::string& with) {
    scene.replace(scene.find(what), what.size(), with);
  };
  replace("poissonRatio='0' ", "poissonRatio='0.1' volumetric='sample' bending='blended' recovery='none' ");
  const std::string across = is_confined
                                 ? "<PartialFixedProjectiveConstraint fixAll='true' fixedDirections='0 1 1'/>"
                                 : "<PartialFixedProjectiveConstraint indices='0 1 2 6 7 8' fixedDirections='0 1 0'/>"
                                   "<PartialFixedProjectiveConstraint indices='0 1 2 3 4 5' fixedDirections='0 0 1'/>";
  replace("<FixedProjectiveConstraint indices='0 3 6 9'/>",
          "<PartialFixedProjectiveConstraint indices='0 3 6 9' fixedDirections='1 0 0'/>" + across);
  return scene;
}

/// In motion: pulled until it flows, then let go.
inline std::string flowing_bar() {
  return bar_of_two(
      "<EulerImplicitSolver rayleighMass='2' rayleighStiffness='0.1'/><SparseLDLSolver/>\n",
      "yieldStress='60' plasticFlowRate='2'",
      "<DiagonalMass totalMass='20'/><LinearForceField name='pull' points='2 5 8 11' times='-0.1 0.5 2.54 2.56' "
      "forces='0 0 0  12.5 0 0  12.5 0 0  0 0 0'/>");
}

}  // namespace hexaplast::support
