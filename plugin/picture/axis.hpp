// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

namespace hexaplast::output {

/// Round numbers along an interval: multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
  double min = 0;  ///< the interval that is shown
  double max = 1;
  std::vector<double> values;  ///< ascending, all within [min, max]
  int decimals = 0;            ///< that tell neighbouring values apart; < 0: written with exponents

  std::string label(double value) const;
};

/// About `count` (>= 2) ticks within [min, max], min < max, two at least; the interval stays as given.
Ticks ticks_within(double min, double max, int count);

/// What is written along a scale of colours: both ends, and between them ticks_within that leave room for those.
std::vector<std::pair<double, std::string>> labels_of_scale(double min, double max, int count);

/// The same with the interval grown outwards to the next tick at both ends (a fiftieth of a step may stand out).
Ticks ticks_around(double min, double max, int count);

}  // namespace hexaplast::output
