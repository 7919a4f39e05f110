// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstdint>

#include "state/history.hpp"
#include "state/linearization.hpp"

namespace hexaplast {

/// What is left of an element's step once it is in the trial history.
struct ElementFlow {
  bool idle = false;  ///< gone, or at rest: the step leaves it as it is
  bool yielded = false, inverted = false, skipped = false;
  bool overflowed = false;  ///< some number of its history, or its dissipated energy, is not finite
  double dissipated = 0;    ///< [J]
};

/// Sections 5.9 and 5.10 of the theory for the elements of one block that are not idle: history -> trial, flows.
/// Returns the elements (a bit each) that it leaves to isolated_step: skipped ones, strains beyond its series,
/// rotations that are not unique, and the spectral norm.
std::uint32_t flow_block(const Model& model, const Linearization& at, double dt, const History& history,
                         const Branches& branches, int block, History& trial, ElementFlow* flows);

}  // namespace hexaplast
