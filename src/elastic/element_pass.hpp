// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "state/linearization.hpp"

namespace hexaplast {

/// One pass over the elements of a chunk at current positions: forces, and what is wanted beside them.
template <class T, class Coef>
struct ElementPass {
  const Partition& partition;
  const double* plastic_rest;            ///< [m] slots
  const double* current;                 ///< [m] slots
  const double* lame;                    ///< [Pa] [block][mu, lambda][element]
  const std::uint16_t* present;          ///< per block: a bit per element that is there and alive
  const unsigned char* is_general;       ///< per block
  const CornerTensors* plastic_inverse;  ///< per element: G of isolated rest shapes, or null
  const unsigned char* has_flowed;       ///< per block: some G is not 1
  const Branches& branches;
  const Settings& settings;
  bool screens;               ///< fills YieldScreen::kNorm
  const double* least_yield;  ///< Linearization::least_yield
  double thin_from;           ///< [-] corner ratio below which an element is thin
  double safe_strain;         ///< nearer to a rotation, no corner is
  double length;              ///< [m] unit of the coefficients
  ElementOperator<T, Coef>& op;
  double* force;        ///< [N] slots, added to
  double* volume;       ///< [m^3] [block][element]
  float* screen;        ///< YieldScreen, per block
  std::uint16_t* thin;  ///< per block, written: Linearization::thin
  float* mean_plastic;  ///< Linearization::mean_plastic, written

  const CornerTensors* flowed_at(int block) const {  // null where nothing has
    return plastic_inverse && has_flowed[block] ? plastic_inverse : nullptr;
  }
  float* mean_plastic_of(int block) const {
    return mean_plastic + static_cast<std::size_t>(block) * kMeanPlastic * kBlock;
  }
};

template <class T, class Coef>
void linearize_elements(const ElementPass<T, Coef>& pass, int chunk);

/// Ap += factor L p in double precision, rotations computed anew: no coefficients are kept.
void add_exact_product(const Model& model, const History& history, const Linearization& at, int chunk, double factor,
                       const double* p, double* Ap);

/// Elastic energy [J] of the elements of a block that are present, at plastic rest and current positions [m] in slots.
/// plastic_inverse: per element, or null where nothing in the block has flowed by isolated rest shapes. thin: written,
/// as Linearization::thin.
double block_energy(const Model& model, const CornerTensors* plastic_inverse, const Branches& branches,
                    const double* plastic_rest, const double* current, std::uint16_t present, int block,
                    std::uint16_t* thin);

using ElementMatrix = Eigen::Matrix<double, 3 * kCorners, 3 * kCorners>;

/// factor times L of the elements of a block [N/m], rotations computed anew; 0 where nothing is. kBlock matrices.
void element_matrices(const Model& model, const History& history, const Linearization& at, int block, double factor,
                      ElementMatrix* matrices);

/// Coefficients with one rotation, as if elements were parallelepipeds, of the blocks of a chunk whose entry in
/// `blocks` is not 0. `op` is of that kind.
void linearize_simple(const Model& model, const Linearization& at, const unsigned char* blocks, int chunk,
                      ElementOperator<float, Half>& op);

/// Marks the blocks of a chunk in which some element that is present is no parallelepiped: edges of one direction
/// differ by more than `alike` of the longest.
void find_general_blocks(const Partition& partition, const double* plastic_rest, const std::uint16_t* present,
                         double alike, int chunk, unsigned char* is_general);

}  // namespace hexaplast
