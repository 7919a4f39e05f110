// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "bench/bar.hpp"

namespace hexaplast::bench {

/// [ns per hexahedron] of the stages of one step of a bar as it stands, each the fastest of several; of the plain
/// implementation the first alone.
struct Stages {
  double linearize_ns = 0;  ///< gradients, rotations, forces, operator coefficients
  double operator_ns = 0;   ///< one product
  double vectors_ns = 0;    ///< one plain conjugate gradient iteration without the product
  double flow_ns = 0;       ///< plastic flow; 0 where nothing flows
};

/// Measures through the library's own verbs, `repetitions` times; the bar stays as it is.
Stages measure_stages(Bar& bar, int repetitions);

}  // namespace hexaplast::bench
