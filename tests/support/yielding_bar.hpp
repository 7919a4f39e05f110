// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

#include "hexaplast/geometry/grid.hpp"
#include "hexaplast/moving_body.hpp"

namespace hexaplast::support {

/// A bar that yields while its upper end is pulled: the example of include/hexaplast/README.md.
inline Body yielding_bar(const Settings& settings = {}) {
  return Body(regular_grid({2, 2, 8}, {0, 0, 0}, {.1, .1, .4}),
              {{.young_modulus = 5000, .poisson_ratio = .45, .yield_stress = 300, .flow_rate = 4}}, settings);
}

inline Motion pulling() {
  return {.fixed = {0, 1, 2, 3, 4, 5, 6, 7, 8}, .load = [](double time, ConstPoints, Points f) {
            if (time < 2) f.bottomRows(9).col(2).array() += .4;
          }};
}

/// Nodes of the upper end of the bar.
inline const std::vector<int> kEnd = {72, 73, 74, 75, 76, 77, 78, 79, 80};

}  // namespace hexaplast::support
