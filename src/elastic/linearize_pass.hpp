// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "state/linearization.hpp"

namespace hexaplast {

/// One pass over elements at the current positions of `at`, which receives what it finds: forces of chunks, stiffness,
/// and what is wanted beside them.
struct LinearizePass {
  const Model& model;
  const History& history;
  const Branches& branches;
  bool screens;        ///< fills YieldScreen::kNorm
  double thin_from;    ///< [-] corner ratio below which an element is thin
  double safe_strain;  ///< nearer to a rotation, no corner is
  Linearization& at;
};

void linearize_elements(const LinearizePass& pass, int chunk);

/// Marks the blocks of a chunk in which some element that is present is no parallelepiped: edges of one direction
/// differ by more than `alike` of the longest.
void find_general_blocks(const Partition& partition, const double* plastic_rest, const std::uint16_t* present,
                         double alike, int chunk, unsigned char* is_general);

}  // namespace hexaplast
