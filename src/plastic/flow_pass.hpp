// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "plastic/flow.hpp"

namespace hexaplast {

/// Sections 5.9 and 5.10 of the theory for the elements of one block that are not idle: history -> trial, flows.
/// Returns the elements (a bit each) that it leaves to isolated_step: skipped ones, strains beyond its series,
/// rotations that are not unique, and the spectral norm.
std::uint32_t flow_block(const Model& model, const Linearization& at, double dt, const History& history,
                         const Branches& branches, int block, History& trial, ElementFlow* flows);

}  // namespace hexaplast
