// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace hexaplast::gpu {

/// One hexahedron, corners and samples in the order of kCornerSign.
struct Hexahedron {
  double X[8][3], x[8][3];  ///< [m] rest and current corners
  double G[8][9], tau[8];   ///< rows; [Pa]
  double mu, lambda;        ///< [Pa]
};
struct FlowNumbers {
  double rate_dt, hardening;
};
/// The same by the formulas of the library in double precision.
struct Answers {
  double force[8][3];                      ///< [N]
  double G[8][9], tau[8], strain[8];       ///< after a step of flow
  double fraction;                         ///< greatest gamma
  double coef[123], weight[2];             ///< lengths [m]
  void multiply(double (&u)[8][3]) const;  ///< u <- L u
};
Answers answers(const Hexahedron& of, const FlowNumbers& rule);

}  // namespace hexaplast::gpu
