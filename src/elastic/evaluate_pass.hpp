// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "state/linearization.hpp"

namespace hexaplast {

/// A block of elements at any positions, without a linearization.
struct EvaluatedBlock {
  const Model& model;
  const CornerTensors* plastic_inverse;  ///< per element; null where nothing in the block has flowed
  const Branches& branches;
  const double *plastic_rest, *current;  ///< [m] slots
  std::uint16_t present;                 ///< a bit per element that is there and alive
  int block;
};

/// Elastic energy [J] of the elements. thin: written, as Linearization::thin.
double block_energy(const EvaluatedBlock& at, std::uint16_t* thin);

/// Of ElementFields, per element.
struct EvaluatedFields {
  double *volume_ratio, *stress_norm, *strain;
};
/// Writes those of the elements. yields: of stress that yields (theory.md section 5.9).
void block_fields(const EvaluatedBlock& at, bool yields, const EvaluatedFields& fields);

}  // namespace hexaplast
