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

/// Gives a member another value.
template <class Options>
void change(const Row<Options>& row, Options& options) {
  if (row.at.list)
    options.*row.at.list = {0.5, 2};
  else
    row.at.set(options, another(row, row.at.get(options)));
}

}  // namespace hexaplast::support
