// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

namespace hexaplast::runner {

/// The multiple of `unit` next to a number that people are shown; zero has no sign.
inline double rounded(double value, double unit) { return std::round(value / unit) * unit + 0.0; }

}  // namespace hexaplast::runner
