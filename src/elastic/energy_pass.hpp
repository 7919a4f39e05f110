// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "state/linearization.hpp"

namespace hexaplast {

/// Elastic energy [J] of the elements of a block that are present, at plastic rest and current positions [m] in slots.
/// plastic_inverse: per element, or null where nothing in the block has flowed by isolated rest shapes. thin: written,
/// as Linearization::thin.
double block_energy(const Model& model, const CornerTensors* plastic_inverse, const Branches& branches,
                    const double* plastic_rest, const double* current, std::uint16_t present, int block,
                    std::uint16_t* thin);

}  // namespace hexaplast
