// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

#include "hexaplast/base/rows.hpp"

namespace hexaplast::support {

/// A value that a member may have, other than this one.
template <class Options>
double another(const Row<Options>& row, double value) {
  for (const double candidate : {value + 1, value / 2, 0.05, 2.0})
    if (candidate != value && row.admits(candidate) &&
        (row.at.type == MemberType::kReal || candidate == std::floor(candidate)))
      return candidate;
  return row.at.type == MemberType::kWord ? 0 : value;
}

}  // namespace hexaplast::support
