// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "plastic/flow.hpp"

namespace hexaplast {

/// The rest shapes of the elements of one block that do not flow, but whose volume is restored: history -> trial.
void restore_block(const Model& model, const Linearization& at, double dt, const History& history, int block,
                   History& trial, ElementFlow* flows);

/// Steps 5.1 to 5.4 of the theory for the elements of one block that are not idle: history -> trial, flows. Isolated
/// rest shapes take 5.9, and elements with branches, whose rest shapes are isolated or stay, 5.10. Returns the
/// elements (a bit each) that it leaves to flow_element: skipped or collapsed ones, strains beyond its series,
/// rotations that are not unique or near half a turn, and what only comparison modes and criteria need.
std::uint32_t flow_block(const Model& model, const Linearization& at, double dt, const History& history,
                         const Branches& branches, int block, History& trial, ElementFlow* flows);

/// Elements of a block (a bit each) of which some corner may have a det J below `ratio` of the initial one, at nodal
/// positions [m] in slots. Errs on the safe side.
std::uint32_t nearly_collapsed(const Model& model, const double* positions, double ratio, int block);

}  // namespace hexaplast
