// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/types.hpp"
#include "hexaplast/material/material.hpp"

namespace hexaplast {

/// Corotated linear elasticity at one sample.                                                 theory.md section 3
///
///   F = R S                                    polar decomposition                            (eq. 6)
///   psi = mu |S - I|^2 + lambda/2 tr(S - I)^2  energy density [J/m^3]                         (eq. 11)
///   sigma = 2 mu (S - I) + lambda tr(S - I) I  stress in the material frame [Pa]              (eq. 12)
///   P   = R sigma                              first Piola stress [Pa], = d psi / dF          (eq. 13)
///   dP  = R (2 mu sym(R^T dF) + lambda tr(R^T dF) I)   with R held fixed                      (eq. 14)
///
/// P is the exact gradient of psi: the part carrying dR vanishes because S - I is symmetric and R^T dR is skew.
/// Inverted samples (det F < 0) arrive with a negative stretch in S and are pushed back.
/// dP keeps only the symmetric part of R^T dF, so that a superposed spin meets no resistance.
double energy_density(const Mat3& S, const Lame& k);
Mat3 stress(const Mat3& S, const Lame& k);
Mat3 stress_increment(const Mat3& R, const Mat3& dF, const Lame& k);

}  // namespace hexaplast
