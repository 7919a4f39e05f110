// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "hexaplast/base/block_matrix.hpp"
#include "hexaplast/state/linearization.hpp"

namespace hexaplast {

/// Element loops of elasticity: gather, compute at the eight samples, integrate, sum at the nodes in ascending element
/// order (so that the bits do not depend on the number of threads).

/// Brings at.rest up to date with history.material.
void update_rest_operators(const Model& model, const History& history, Linearization& at);

/// Rotations and corner forces at world positions x (num_nodes x 3) [m].                      theory.md eq. 15
void linearize(const Model& model, const History& history, ConstPoints x, Linearization& at);

/// f += elastic forces [N].
void add_force(const Model& model, const Linearization& at, Points f);

/// df += factor * (df/dx) dx with the rotations of `at`; `corner` is scratch, one entry per element.        eq. 16
void add_stiffness_product(const Model& model, const Linearization& at, double factor, ConstPoints dx,
                           std::vector<ElementPoints>& corner, Points df);

/// K += factor * df/dx.                                                                                       eq. 17
void add_stiffness_blocks(const Model& model, const Linearization& at, double factor, BlockMatrix& K);

/// Elastic energy [J] at x.                                                                                   eq. 18
double energy(const Model& model, const History& history, ConstPoints x);

}  // namespace hexaplast
