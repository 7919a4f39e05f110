// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "elastic/evaluate_pass.hpp"
#include "hexaplast/base/block_matrix.hpp"
#include "state/linearization.hpp"

namespace hexaplast {

/// Elasticity of a body at one set of positions: the element kernels, chunk by chunk.

/// Brings what `at` holds of the plastic rest shape up to date with the history.
void update_material(const Model& model, const History& history, Linearization& at);

/// Current positions x (num_nodes x 3) [m] alone: all that the plastic step needs besides what the latest linearize has
/// found of the plastic rest shape, which must still be the present one.
void set_positions(const Model& model, ConstPoints x, Linearization& at);

/// After a plastic step that has removed nothing, at positions that `at` has: what has flowed in it lies in these
/// blocks, per block not 0, and the rest of `at` stays.
void take_flow(const Model& model, const History& history, std::span<const unsigned char> blocks, Linearization& at);

/// Rotations, forces and the stiffness operator at current positions x (num_nodes x 3) [m]; nothing where `at` holds
/// them already. screens: fills YieldScreen too; of what branches hold it knows nothing. theory.md eq. 15, 16,
/// P14
void linearize(const Model& model, const History& history, ConstPoints x, Linearization& at, bool screens = true,
               std::span<const BranchStep> branches = {});

/// f += elastic forces [N].
void add_force(const Model& model, const Linearization& at, Points f);

/// Scratch of add_stiffness_product and energy: the vectors of products in single precision, and sums.
struct ProductWorkspace {
  AlignedVector<float> argument, product;
  std::vector<double> energy;       ///< [J] per block
  std::vector<std::uint16_t> thin;  ///< per block, as Linearization::thin
  Recovery recovery;                ///< at the positions of the energy
  double sum = 0;                   ///< [J] the energy
  PointArray x;                     ///< [m] its positions
  long version = -1;                ///< History::version that it belongs to; -1 where branches take another step
};

/// df += factor * (df/dx) dx with the rotations of `at`.                                                      eq. 16
void add_stiffness_product(const Model& model, const Linearization& at, double factor, ConstPoints dx,
                           SlotScratch& slots, ProductWorkspace& work, Points df);

/// K += factor * df/dx. Elements that are gone add zeros.                                                     eq. 17
void add_stiffness_blocks(const Model& model, const History& history, const Linearization& at, double factor,
                          BlockMatrix& K);

/// Elastic energy [J] at x, that of the springs of `recovery` included; asked for the same again, `work` has it.
///                                                                                                 eq. 18, E25, P17
double energy(const Model& model, const History& history, ConstPoints x, SlotScratch& slots, ProductWorkspace& work,
              std::span<const BranchStep> branches = {});

/// Writes the fields of the elements that are there, at x.
void find_fields(const Model& model, const History& history, ConstPoints x, std::span<const BranchStep> branches,
                 SlotScratch& slots, const EvaluatedFields& fields);

}  // namespace hexaplast
